//! Meshes of scanners and pose data sets: PLY, text or binary, converted to a binary glTF file.
//! Axes and units stay.
//!
//! Source: Greg Turk, «The PLY Polygon File Format»; colours are sRGB codes, textures begin at
//! their lower left corner.

use std::path::Path;

use app_core::session::{Files, Folder};
use app_scene::geometry::color::linear_from_srgb;

use super::error::{ImportError, ImportReason};
use super::glb::{Mesh, Texture, glb};

/// Limit for the corners of a face; a file with more is damaged.
const MAX_CORNERS: u64 = 1 << 16;
/// Limit for vertices and for faces.
const MAX_ELEMENTS: u64 = 16 << 20;
/// Limit for a texture's size.
const MAX_TEXTURE_BYTES: u64 = 256 << 20;

/// The encoding of numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// The type of a number.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

struct Property {
    name: String,
    kind: Kind,
    /// Type of a list's length.
    list: Option<Kind>,
}

struct Element {
    name: String,
    n: u64,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    texture: Option<String>,
}

fn wrong(reason: impl Into<String>) -> ImportReason {
    ImportReason::Mesh(reason.into())
}

/// The mesh of a file as binary glTF, with the texture beside it.
pub(super) fn glb_of_ply_file(path: &Path, bytes: &[u8]) -> anyhow::Result<Vec<u8>> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = Folder::open(folder.unwrap_or(Path::new(".")))?;
    Ok(glb_of_ply(bytes, &|name| {
        folder.read(name, MAX_TEXTURE_BYTES).ok()
    })?)
}

/// The mesh of a file as binary glTF. `beside` reads the texture that it names.
///
/// # Errors
/// When it is no mesh of triangles or polygons, or is cut.
pub fn glb_of_ply(bytes: &[u8], beside: &dyn Fn(&str) -> Option<Vec<u8>>) -> Result<Vec<u8>, ImportError> {
    let refused = |reason| ImportError::new("the mesh", "the file", reason);
    let (header, body) = header(bytes).map_err(refused)?;
    let mesh = mesh(&header, body).map_err(refused)?;
    let texture = match &header.texture {
        Some(name) if !mesh.tex_coords.is_empty() => {
            let missing = || ImportError::new(name, "the texture", ImportReason::Missing);
            let bytes = beside(name).ok_or_else(missing)?;
            let media_type = if bytes.starts_with(b"\x89PNG") {
                "image/png"
            } else {
                "image/jpeg"
            };
            Some(Texture { bytes, media_type })
        }
        _ => None,
    };
    Ok(glb(&mesh, texture.as_ref()))
}

/// The header up to `end_header`, and the bytes after it.
fn header(bytes: &[u8]) -> Result<(Header, &[u8]), ImportReason> {
    let mut rest = bytes;
    let mut header = Header {
        encoding: Encoding::Text,
        elements: Vec::new(),
        texture: None,
    };
    loop {
        let end = rest.iter().position(|byte| *byte == b'\n');
        let end = end.ok_or_else(|| wrong("the header has no line `end_header`"))?;
        let line = std::str::from_utf8(&rest[..end]).map_err(|_| ImportReason::NotText)?;
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["end_header"] => return Ok((header, rest)),
            ["format", name, ..] => header.encoding = encoding(name)?,
            ["comment", "TextureFile", ..] => {
                let name = line
                    .split_once("TextureFile")
                    .map(|(_, name)| name.trim().to_owned());
                header.texture = name;
            }
            ["element", name, n] => header.elements.push(Element {
                name: (*name).to_owned(),
                n: n.parse()
                    .map_err(|_| wrong(format!("{n:?} is no number of elements")))?,
                properties: Vec::new(),
            }),
            ["property", words @ ..] => {
                let element = header.elements.last_mut();
                let element = element.ok_or_else(|| wrong("a property stands before the first element"))?;
                element.properties.push(property(words)?);
            }
            _ => {}
        }
    }
}

impl Header {
    /// Refuses texture coordinates that are stored per face, as MeshLab writes them.
    fn check_texture(&self) -> Result<(), ImportReason> {
        let is_of_faces = |property: &Property| property.name == "texcoord" && property.list.is_some();
        let mut elements = self.elements.iter();
        let in_faces = elements
            .clone()
            .any(|element| element.name == "face" && element.properties.iter().any(is_of_faces));
        let in_vertices =
            elements.any(|element| element.name == "vertex" && Columns::of(element).tex_coord.is_some());
        if self.texture.is_some() && in_faces && !in_vertices {
            return Err(wrong(
                "its texture coordinates stand in its faces: export it with texture coordinates per vertex, as by the filter \
                 `Convert PerWedge UV into PerVertex UV` of MeshLab",
            ));
        }
        Ok(())
    }
}

fn encoding(name: &str) -> Result<Encoding, ImportReason> {
    match name {
        "ascii" => Ok(Encoding::Text),
        "binary_little_endian" => Ok(Encoding::Little),
        "binary_big_endian" => Ok(Encoding::Big),
        _ => Err(wrong(format!("no such format as {name:?}"))),
    }
}

fn property(words: &[&str]) -> Result<Property, ImportReason> {
    let (list, kind, name) = match words {
        ["list", length, kind, name] => (Some(self::kind(length)?), kind, name),
        [kind, name] => (None, kind, name),
        _ => return Err(wrong(format!("no such property as {:?}", words.join(" ")))),
    };
    Ok(Property {
        name: (*name).to_owned(),
        kind: self::kind(kind)?,
        list,
    })
}

fn kind(name: &str) -> Result<Kind, ImportReason> {
    Ok(match name {
        "char" | "int8" => Kind::I8,
        "uchar" | "uint8" => Kind::U8,
        "short" | "int16" => Kind::I16,
        "ushort" | "uint16" => Kind::U16,
        "int" | "int32" => Kind::I32,
        "uint" | "uint32" => Kind::U32,
        "float" | "float32" => Kind::F32,
        "double" | "float64" => Kind::F64,
        _ => return Err(wrong(format!("no such type as {name:?}"))),
    })
}

/// Numbers in sequence, in any encoding.
struct Numbers<'a> {
    encoding: Encoding,
    rest: &'a [u8],
}

impl Numbers<'_> {
    fn next(&mut self, kind: Kind) -> Result<f64, ImportReason> {
        match self.encoding {
            Encoding::Text => self.word(),
            Encoding::Little => self.binary(kind, |bytes| bytes),
            Encoding::Big => self.binary(kind, |mut bytes| {
                bytes.reverse();
                bytes
            }),
        }
    }

    fn word(&mut self) -> Result<f64, ImportReason> {
        let text = self.rest.trim_ascii_start();
        let end = text
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.rest = rest;
        let word = std::str::from_utf8(word).map_err(|_| ImportReason::NotText)?;
        word.parse().map_err(|_| match word {
            "" => wrong("it ends too early"),
            word => ImportReason::NotANumber(word.to_owned()),
        })
    }

    fn binary(&mut self, kind: Kind, order: fn(Vec<u8>) -> Vec<u8>) -> Result<f64, ImportReason> {
        let taken = self.rest.split_at_checked(kind.n_bytes());
        let (bytes, rest) = taken.ok_or_else(|| wrong("it ends too early"))?;
        self.rest = rest;
        let bytes = order(bytes.to_vec());
        kind.read(&bytes).ok_or_else(|| wrong("it ends too early"))
    }
}

impl Kind {
    fn n_bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Reads little-endian bytes.
    fn read(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::I8 => i8::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::U8 => u8::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::I16 => i16::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::U16 => u16::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::I32 => i32::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::U32 => u32::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::F32 => f32::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }
}

fn mesh(header: &Header, body: &[u8]) -> Result<Mesh, ImportReason> {
    let mut numbers = Numbers {
        encoding: header.encoding,
        rest: body,
    };
    let mut mesh = Mesh::default();
    header.check_texture()?;
    for element in &header.elements {
        if element.n > MAX_ELEMENTS || (element.n > 0 && element.properties.is_empty()) {
            return Err(ImportReason::Count(element.n));
        }
        let columns = Columns::of(element);
        for _ in 0..element.n {
            let mut values = Vec::with_capacity(element.properties.len().min(32));
            let mut corners = Vec::new();
            for property in &element.properties {
                let Some(length) = property.list else {
                    values.push(numbers.next(property.kind)?);
                    continue;
                };
                let list = list(&mut numbers, length, property.kind)?;
                if ["vertex_indices", "vertex_index"].contains(&property.name.as_str()) {
                    corners = list;
                }
                values.push(0.0);
            }
            match element.name.as_str() {
                "vertex" => columns.add_vertex(&mut mesh, &values, header)?,
                "face" => add_face(&mut mesh.indices, &corners)?,
                _ => {}
            }
        }
    }
    let n_vertices = mesh.positions.len() as u64;
    if mesh.indices.iter().any(|index| u64::from(*index) >= n_vertices) {
        return Err(wrong("a face refers to a vertex that does not exist"));
    }
    if mesh.indices.is_empty() {
        return Err(wrong(
            "it has no faces: a cloud of points is no toy: reconstruct its surface, for example by MeshLab",
        ));
    }
    Ok(mesh)
}

fn list(numbers: &mut Numbers, length: Kind, kind: Kind) -> Result<Vec<f64>, ImportReason> {
    let n = numbers.next(length)?;
    #[expect(clippy::cast_precision_loss, reason = "65536")]
    let is_allowed = n >= 0.0 && n <= MAX_CORNERS as f64 && n.fract() == 0.0;
    if !is_allowed {
        return Err(wrong(format!("a face has {n} corners")));
    }
    let mut list = Vec::new();
    let mut left = n;
    while left > 0.0 {
        list.push(numbers.next(kind)?);
        left -= 1.0;
    }
    Ok(list)
}

/// Splits a face into triangles around its first corner.
fn add_face(indices: &mut Vec<u32>, corners: &[f64]) -> Result<(), ImportReason> {
    let whole = |corner: &f64| {
        let is_index = (0.0..=f64::from(u32::MAX)).contains(corner) && corner.fract() == 0.0;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index of 32 bits"
        )]
        let index = *corner as u32;
        is_index.then_some(index)
    };
    let corners: Option<Vec<u32>> = corners.iter().map(whole).collect();
    let corners = corners.ok_or_else(|| wrong("a face refers to a vertex that does not exist"))?;
    if let Some((first, others)) = corners.split_first() {
        indices.extend(others.windows(2).flat_map(|pair| [*first, pair[0], pair[1]]));
    }
    Ok(())
}

/// Indices of a vertex's numbers among its properties.
struct Columns {
    position: Option<[usize; 3]>,
    normal: Option<[usize; 3]>,
    color: Option<([usize; 3], f64)>,
    tex_coord: Option<[usize; 2]>,
}

impl Columns {
    fn of(element: &Element) -> Self {
        let at = |name: &str| {
            element
                .properties
                .iter()
                .position(|property| property.name == name)
        };
        let three = |names: [&str; 3]| Some([at(names[0])?, at(names[1])?, at(names[2])?]);
        let two = |names: [&str; 2]| Some([at(names[0])?, at(names[1])?]);
        let color = three(["red", "green", "blue"])
            .or_else(|| three(["diffuse_red", "diffuse_green", "diffuse_blue"]));
        Self {
            position: three(["x", "y", "z"]),
            normal: three(["nx", "ny", "nz"]),
            color: color.map(|columns| {
                let most = match element.properties[columns[0]].kind {
                    Kind::U16 => 65535.0,
                    Kind::F32 | Kind::F64 => 1.0,
                    _ => 255.0,
                };
                (columns, most)
            }),
            tex_coord: two(["texture_u", "texture_v"])
                .or_else(|| two(["s", "t"]))
                .or_else(|| two(["u", "v"])),
        }
    }

    fn add_vertex(&self, mesh: &mut Mesh, values: &[f64], header: &Header) -> Result<(), ImportReason> {
        let single = |index: usize| {
            #[expect(clippy::cast_possible_truncation, reason = "coordinates of a mesh")]
            let value = values[index] as f32;
            if value.is_finite() {
                Ok(value)
            } else {
                Err(ImportReason::NotANumber(values[index].to_string()))
            }
        };
        let three = |[x, y, z]: [usize; 3]| -> Result<[f32; 3], ImportReason> {
            Ok([single(x)?, single(y)?, single(z)?])
        };
        let position = self
            .position
            .ok_or_else(|| wrong("its vertices have no x, y and z"))?;
        mesh.positions.push(three(position)?);
        if let Some(normal) = self.normal {
            let [x, y, z] = three(normal)?;
            let length = (x * x + y * y + z * z).sqrt();
            // A zero vector is replaced by any unit vector.
            let unit = if length > 0.0 {
                [x, y, z].map(|part| part / length)
            } else {
                [0.0, 1.0, 0.0]
            };
            mesh.normals.push(unit);
        }
        if let (Some([u, v]), Some(_)) = (self.tex_coord, &header.texture) {
            mesh.tex_coords.push([single(u)?, 1.0 - single(v)?]);
        } else if let Some((columns, most)) = self.color {
            let code = |column: usize| {
                #[expect(clippy::cast_possible_truncation, reason = "from 0 to 1")]
                let code = (values[column] / most).clamp(0.0, 1.0) as f32;
                linear_from_srgb(code)
            };
            mesh.colors.push(columns.map(code));
        }
        Ok(())
    }
}
