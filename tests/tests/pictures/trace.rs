//! The work that a device gets, by its own trace: objects, and draws, attachments and bindings of
//! each pass, computed from the trace alone.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs;
use std::path::{Path, PathBuf};

use app_core::Core;
use app_core::frame::{FrameInput, FrameReport};
use app_core::wgpu::{self, Instance, InstanceDescriptor};
use app_pipeline::gpu::context::phone_limits;

/// A core on a device that records its work.
pub(crate) struct Traced {
    pub(crate) core: Core,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    trace: PathBuf,
    /// Number of bytes of the trace that are read.
    n_read: usize,
    objects: Objects,
}

impl Traced {
    pub(crate) fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        // Files of an earlier run.
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let opened = pollster::block_on(adapter.unwrap().request_device(&wgpu::DeviceDescriptor {
            required_limits: phone_limits(),
            trace: wgpu::Trace::Directory(folder.clone()),
            ..Default::default()
        }));
        let (device, queue) = opened.unwrap();
        Self {
            core: Core::on_device(device.clone(), queue.clone()).unwrap(),
            device,
            queue,
            trace: folder.join("trace.ron"),
            n_read: 0,
            objects: Objects::default(),
        }
    }

    /// The whole trace.
    pub(crate) fn text(&self) -> String {
        fs::read_to_string(&self.trace).unwrap()
    }

    /// The device's work since the previous call.
    pub(crate) fn given(&mut self) -> Given {
        let text = self.text();
        let given = self.objects.take(&text[self.n_read..]);
        self.n_read = text.len();
        given
    }

    /// Makes the picture of a frame; returns its report and the device's work for it.
    pub(crate) fn frame(&mut self, input: &FrameInput) -> (FrameReport, Given) {
        self.given();
        let report = self.core.frame(input).unwrap();
        (report, self.given())
    }
}

/// The work of a device.
#[derive(Debug, Default)]
pub(crate) struct Given {
    /// Passes by their labels.
    pub(crate) passes: BTreeMap<String, Pass>,
    /// Number of calls of each action that creates an object.
    pub(crate) created: BTreeMap<String, u64>,
}

impl Given {
    /// Number of objects whose creating action has `what` in its name.
    pub(crate) fn n_created(&self, what: &str) -> u64 {
        let of_kind = self.created.iter().filter(|(action, _)| action.contains(what));
        of_kind.map(|(_, n)| n).sum()
    }

    /// Number of runs of each pass.
    pub(crate) fn runs(&self) -> BTreeMap<&str, u32> {
        let passes = self.passes.iter();
        passes
            .map(|(label, pass)| (label.as_str(), pass.n_runs))
            .collect()
    }
}

/// Work of a pass, over all of its runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pass {
    pub(crate) n_runs: u32,
    pub(crate) n_draws: u32,
    pub(crate) triangles: u64,
    pub(crate) vertices: u64,
    pub(crate) bytes_written: u64,
    /// `None` for a compute pass, whose shader alone determines its reads.
    pub(crate) bytes_read: Option<u64>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Texture {
    size: [u64; 3],
    texel_bytes: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct View {
    of: u64,
    first_layer: u64,
    n_layers: u64,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Uniform {
        n_bytes: u64,
        is_dynamic: bool,
    },
    Storage {
        is_written: bool,
    },
    Depth,
    /// A sampler that compares: depths that are bound with it are sampled at positions other than
    /// the drawn ones.
    Comparison,
    Other,
}

/// Objects that exist on the device.
#[derive(Debug, Default)]
pub(crate) struct Objects {
    textures: HashMap<u64, Texture>,
    views: HashMap<u64, View>,
    buffers: HashMap<u64, u64>,
    layouts: HashMap<u64, Vec<Kind>>,
    /// Layout, then the bound resources.
    groups: HashMap<u64, (u64, Vec<u64>)>,
}

/// The number after `key` in a line.
fn after(line: &str, key: &str) -> Option<u64> {
    let rest = &line[line.find(key)? + key.len()..];
    let rest = rest.trim_start_matches(|c: char| !c.is_ascii_digit());
    let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

fn pointer(line: &str) -> Option<u64> {
    after(line, "PointerId(")
}

/// The first number after `key` in some lines; `None` if the first such line has `None`.
fn number(lines: &[&str], key: &str) -> Option<u64> {
    let line = lines.iter().find(|line| line.trim_start().starts_with(key))?;
    after(line, key)
}

/// Bytes of a texel, by WebGPU's name of the format.
fn texel_bytes(format: &str) -> u64 {
    match format {
        "r8unorm" => 1,
        "rg8unorm" | "rg8uint" | "r16float" | "depth16unorm" => 2,
        "rgba8unorm" | "rgba8unorm-srgb" | "rg16float" | "depth32float" => 4,
        "rgba16float" => 8,
        "rgba32float" => 16,
        other => panic!("{other}"),
    }
}

/// Lines from `first` on to the one that closes its bracket, at the same depth.
fn block<'a>(lines: &'a [&'a str], first: usize) -> &'a [&'a str] {
    let depth = |line: &str| line.len() - line.trim_start().len();
    let own = depth(lines[first]);
    let rest = lines[first + 1..].iter();
    let n_within = rest.take_while(|line| depth(line) > own).count();
    let n_lines = if n_within == 0 { 1 } else { n_within + 2 };
    &lines[first..(first + n_lines).min(lines.len())]
}

/// Number of pixels covered by a pass's draws from line `first` on: its parts are disjoint.
fn n_drawn_from(text: &[&str], first: usize) -> u64 {
    let is = |index: usize, name: &str| text[index].trim_start().starts_with(name);
    let part_of = |draw: usize| (0..draw).rev().find(|index| is(*index, "SetScissor("));
    let draws = (first..text.len()).filter(|index| is(*index, "Draw"));
    let parts: BTreeSet<Option<usize>> = draws.map(part_of).collect();
    let area = |part: &Option<usize>| {
        let side = |key| part.map_or(u64::MAX, |index| number(block(text, index), key).unwrap());
        side("w:").saturating_mul(side("h:"))
    };
    parts.iter().map(area).fold(0, u64::saturating_add)
}

impl Objects {
    /// Processes a part of a trace; returns its content.
    pub(crate) fn take(&mut self, trace: &str) -> Given {
        let lines: Vec<&str> = trace.lines().collect();
        let mut given = Given::default();
        let mut at = 0;
        while at < lines.len() {
            let text = block(&lines, at);
            let line = lines[at].trim_start();
            if line.starts_with("Create") {
                let action = line.split('(').next().unwrap_or_default();
                *given.created.entry(action.to_owned()).or_default() += 1;
                self.create(line, text);
                at += text.len();
            } else if line.starts_with("RunRenderPass") || line.starts_with("RunComputePass") {
                self.pass(text, &mut given.passes);
                at += text.len();
            } else {
                at += 1;
            }
        }
        given
    }

    fn create(&mut self, line: &str, text: &[&str]) {
        let id = pointer(line).or_else(|| text.iter().find_map(|line| pointer(line)));
        let Some(id) = id else {
            return;
        };
        if line.starts_with("CreateTextureView") {
            let of = pointer(text[2]).unwrap();
            let given = number(text, "arrayLayerCount: Some");
            let view = View {
                of,
                first_layer: number(text, "baseArrayLayer:").unwrap_or(0),
                n_layers: given.unwrap_or(self.textures[&of].size[2]),
            };
            self.views.insert(id, view);
        } else if line.starts_with("CreateTexture(") {
            let side = |key| number(text, key).unwrap();
            let format = text.iter().find(|line| line.trim_start().starts_with("format:"));
            let format = format.unwrap().split('"').nth(1).unwrap();
            let texture = Texture {
                size: [side("width:"), side("height:"), side("depthOrArrayLayers:")],
                texel_bytes: texel_bytes(format) * side("sample_count:"),
            };
            self.textures.insert(id, texture);
        } else if line.starts_with("CreateBuffer(") {
            self.buffers.insert(id, number(text, "size:").unwrap());
        } else if line.starts_with("CreateBindGroupLayout(") {
            self.layouts.insert(id, kinds(text));
        } else if line.starts_with("CreateBindGroup(") {
            let layout = text.iter().find(|line| line.trim_start().starts_with("layout:"));
            let bound = text.iter().filter(|line| !line.contains("layout:"));
            let bound = bound.skip(1).filter_map(|line| pointer(line)).collect();
            self.groups.insert(id, (pointer(layout.unwrap()).unwrap(), bound));
        }
    }

    fn view(&self, id: u64) -> (Texture, View) {
        let view = self.views[&id];
        (self.textures[&view.of], view)
    }

    /// Bytes of one sample of all texels of a view.
    fn view_bytes(&self, id: u64) -> u64 {
        let (texture, view) = self.view(id);
        texture.size[0] * texture.size[1] * view.n_layers * texture.texel_bytes
    }

    fn pass(&self, text: &[&str], passes: &mut BTreeMap<String, Pass>) {
        let label = text
            .iter()
            .find_map(|line| line.trim().strip_prefix("label: Some(\""));
        let label = label.unwrap().split('"').next().unwrap();
        let given = passes.entry(label.to_owned()).or_default();
        given.n_runs += 1;
        let is_drawn = text[0].contains("RunRenderPass");
        let mut read = 0;
        let mut n_pixels = u64::MAX;
        if is_drawn {
            (n_pixels, read) = self.attachments(text, given);
        }
        let mut seen = BTreeSet::new();
        for (index, line) in text.iter().enumerate() {
            let within = || block(text, index);
            let of = |key| number(within(), key).unwrap();
            match line.trim().trim_end_matches('(') {
                "SetBindGroup" => {
                    let group = within().iter().find_map(|line| pointer(line)).unwrap();
                    let n_seen = n_pixels.min(n_drawn_from(text, index));
                    let (bytes_read, bytes_written) = self.bound(group, n_seen, &mut seen);
                    read += bytes_read;
                    given.bytes_written += bytes_written;
                }
                "SetVertexBuffer" => {
                    let id = within().iter().find_map(|line| pointer(line)).unwrap();
                    if seen.insert([id, 0, 0]) {
                        read += self.buffers[&id];
                    }
                }
                name @ ("Draw" | "DrawIndexed") => {
                    let is_indexed = name == "DrawIndexed";
                    let n = of(if is_indexed {
                        "index_count:"
                    } else {
                        "vertex_count:"
                    });
                    let n_instances = of("instance_count:");
                    given.n_draws += 1;
                    given.triangles += n / 3 * n_instances;
                    given.vertices += n * n_instances;
                    read += if is_indexed { 4 * n } else { 0 };
                }
                dispatch if dispatch.starts_with("DispatchWorkgroups") => given.n_draws += 1,
                _ => {}
            }
        }
        if is_drawn {
            *given.bytes_read.get_or_insert(0) += read;
        }
    }

    /// Pixels of a pass, and bytes that its attachments load; the bytes that they store are added.
    fn attachments(&self, text: &[&str], given: &mut Pass) -> (u64, u64) {
        let (mut n_pixels, mut read, mut current) = (None, 0, None);
        let first = text
            .iter()
            .position(|line| line.contains("color_attachments"))
            .unwrap();
        for line in &text[first..] {
            let line = line.trim();
            if line.starts_with("view:") {
                let id = pointer(line).unwrap();
                let [width, height, _] = self.view(id).0.size;
                n_pixels.get_or_insert(width * height);
                current = Some(id);
            } else if line.starts_with("resolve_target: Some") {
                given.bytes_written += self.view_bytes(pointer(line).unwrap());
            } else if line == "load_op: load," || line == "load: load," {
                read += self.view_bytes(current.unwrap());
            } else if line == "store_op: store," || line == "store: store," {
                given.bytes_written += self.view_bytes(current.unwrap());
            }
        }
        (n_pixels.unwrap(), read)
    }

    /// Bytes that a pass reads and writes through a group, without resources that are already in
    /// `seen`.
    fn bound(&self, group: u64, n_pixels: u64, seen: &mut BTreeSet<[u64; 3]>) -> (u64, u64) {
        let (layout, bound) = &self.groups[&group];
        let (mut read, mut written) = (0, 0);
        let compares = self.layouts[layout]
            .iter()
            .any(|kind| matches!(kind, Kind::Comparison));
        for (index, (kind, id)) in self.layouts[layout].iter().zip(bound).enumerate() {
            match *kind {
                Kind::Uniform { n_bytes, is_dynamic } => {
                    let key = if is_dynamic {
                        [group, index as u64, 1]
                    } else {
                        [*id, 0, 0]
                    };
                    read += if seen.insert(key) { n_bytes } else { 0 };
                }
                Kind::Storage { is_written } => {
                    if seen.insert([*id, 0, 0]) {
                        read += self.buffers[id];
                        written += if is_written { self.buffers[id] } else { 0 };
                    }
                }
                Kind::Depth | Kind::Comparison | Kind::Other => {
                    let Some(view) = self.views.get(id) else {
                        continue;
                    };
                    if seen.insert([view.of, view.first_layer, view.n_layers]) {
                        let texture = self.textures[&view.of];
                        let is_whole = compares && matches!(kind, Kind::Depth);
                        let most = if is_whole { u64::MAX } else { n_pixels };
                        let n_texels = (texture.size[0] * texture.size[1]).min(most);
                        read += n_texels * view.n_layers * texture.texel_bytes;
                    }
                }
            }
        }
        (read, written)
    }
}

fn kinds(text: &[&str]) -> Vec<Kind> {
    let entries = text
        .iter()
        .enumerate()
        .filter(|(_, line)| line.trim_start().starts_with("ty: "));
    let mut kinds = Vec::new();
    for (index, line) in entries {
        match line.trim() {
            "ty: Buffer(" => {}
            "ty: Uniform," => kinds.push(Kind::Uniform {
                is_dynamic: text[index + 1].contains("true"),
                n_bytes: after(text[index + 2], "Some(").unwrap(),
            }),
            "ty: Storage(" => kinds.push(Kind::Storage {
                is_written: text[index + 1].contains("false"),
            }),
            "ty: Texture(" if text[index + 1].contains("Depth") => kinds.push(Kind::Depth),
            "ty: Sampler(comparison)," => kinds.push(Kind::Comparison),
            _ => kinds.push(Kind::Other),
        }
    }
    kinds
}
