/* Values of pictures. A page that was opened from disk may show a picture, but not read it: a script hands its bytes over. */

const FIRST_CHARACTER = 0x100;
const MOST_KEPT = 24;
const known = new Map();

/* Called by the scripts of the folder "values". */
window.takeValues = (file, text) => {
  const bytes = Uint8Array.from(text, character => character.charCodeAt(0) - FIRST_CHARACTER);
  createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none", premultiplyAlpha: "none" })
    .then(bitmap => {
      const canvas = el("canvas", { width: bitmap.width, height: bitmap.height });
      const context = canvas.getContext("2d", { willReadFrequently: true });
      context.drawImage(bitmap, 0, 0);
      known.set(file, context.getImageData(0, 0, bitmap.width, bitmap.height));
      showValues();
    })
    .catch(() => { known.set(file, "none"); showValues(); });
};

/* The values of a file: "wait" until they are there, "none" if they never will be. */
function valuesOf(file) {
  if (!known.has(file)) {
    if (known.size >= MOST_KEPT) known.delete(known.keys().next().value);
    known.set(file, "wait");
    const script = el("script", { src: `values/${file}.js` });
    script.addEventListener("error", () => { known.set(file, "none"); showValues(); });
    script.addEventListener("load", () => script.remove());
    document.head.append(script);
  }
  return known.get(file);
}

const linear = code => code / 255 <= 0.04045 ? code / 255 / 12.92 : ((code / 255 + 0.055) / 1.055) ** 2.4;
const short = value => value.toFixed(4).replace(/^0/, "");

/* One picture's values at a pixel, in words. */
function valueText(file, [x, y]) {
  if (!file) return { text: "colours as its legend says", codes: null };
  const values = valuesOf(file);
  if (values === "wait") return { text: "\u2026", codes: null };
  if (values === "none") return { text: "its values are not at hand", codes: null };
  const codes = [...values.data.slice(4 * (y * values.width + x), 4 * (y * values.width + x) + 3)];
  return { text: `${codes.join(" ")}, linear ${codes.map(code => short(linear(code))).join(" ")}`, codes };
}

let pointed = null;
function point(pixel) {
  pointed = pixel;
  showValues();
}

function showValues() {
  viewers.forEach(viewer => {
    if (viewer.node.hidden) return;
    if (!pointed) {
      viewer.readout.replaceChildren(el("span", { class: "soft" }, "Point at a picture for its values."));
      return;
    }
    const [a, b] = viewer.sides.map(side => valueText(side.valueFile, pointed));
    const apart = a.codes && b.codes ? `B \u2212 A: ${b.codes.map((code, i) => code - a.codes[i]).join(" ")}` : "";
    viewer.readout.replaceChildren(el("span", {}, `x ${pointed[0]}, y ${pointed[1]} px`),
      el("span", {}, el("b", {}, "A "), a.text), el("span", {}, el("b", {}, "B "), b.text), apart && el("span", {}, apart));
  });
}
