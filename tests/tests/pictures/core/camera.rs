//! From a camera's planes to a screen's picture, and an effect that fades in and out.

use app_core::Core;
use app_core::camera_frame::{CameraImage, CodeRange, Display, Fit, LumaCoefficients, YcbcrEncoding};
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::wgpu;
use app_pipeline::gpu::context::phone_limits;
use app_scene::geometry::color::linear_from_srgb;
use glam::DVec2;
use measure::planar::{BT601_FULL, planar};

use crate::core::bundled::{core, first_input, picture_of, scene};

fn worst(a: &[u8], b: &[u8]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

#[test]
fn planes_are_decoded_on_the_device_as_on_the_processor() {
    let (scene, input) = (scene(), first_input());
    let mut core = core();
    for coefficients in [LumaCoefficients::Bt601, LumaCoefficients::Bt709] {
        for range in [CodeRange::Full, CodeRange::Video] {
            core.set_scene(scene.clone(), Preset::Balanced).unwrap();
            let image = planar(input.image.rgba(), YcbcrEncoding { coefficients, range }).unwrap();
            let shown = input
                .clone()
                .with_image(image)
                .with_shown_pose(scene.physical_pose.clone());
            let picture = picture_of(&mut core, &shown);
            // Half a code of rounding in either direction.
            assert!(worst(&picture, &shown.image.rgba().rgba8) <= 1);
            // The chroma of an encoded picture is coarser; the mean would show another table of
            // coefficients.
            let pairs = picture.iter().zip(&input.image.rgba().rgba8);
            let sum: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            assert!(sum < picture.len() as u64, "{coefficients:?} {range:?}: {sum}");
        }
    }
}

#[test]
fn a_frame_of_planes_gives_the_picture_of_its_pixels() {
    let (scene, input) = (scene(), first_input());
    let mut core = core();
    let planes = CameraImage::from(planar(input.image.rgba(), BT601_FULL).unwrap());
    let pixels = CameraImage::Rgba(planes.rgba().clone());
    let [a, b] = [planes, pixels].map(|image| {
        core.set_scene(scene.clone(), Preset::Balanced).unwrap();
        let input = input.clone().with_image(image);
        picture_of(&mut core, &input)
    });
    // A code of the frame may be rounded differently; the result changes little more.
    let pairs = a.iter().zip(&b);
    let far = pairs.filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(far * 1000 < a.len(), "{far} of {} codes", a.len());
}

#[test]
fn half_an_effect_is_half_way_in_linear_light() {
    let (scene, input) = (scene(), first_input());
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let mut at = |effect| picture_of(&mut core, &input.clone().with_effect(effect));
    let (none, whole, half) = (at(0.0), at(1.0), at(0.5));
    assert!(none == input.image.rgba().rgba8, "the camera's picture");
    assert!(worst(&none, &whole) > 30, "nothing is shown");
    let [none, whole, half] = [none, whole, half].map(|picture| -> Vec<f64> {
        picture
            .iter()
            .map(|code| f64::from(linear_from_srgb(f32::from(*code) / 255.0)))
            .collect()
    });
    // Half a code of each, which is less than .006 at white.
    for ((none, whole), half) in none.iter().zip(&whole).zip(&half) {
        assert!(
            (0.5 * (none + whole) - half).abs() < 0.006,
            "{none} {whole} {half}"
        );
    }
}

#[test]
fn an_effect_beyond_its_range_is_refused() {
    let (scene, input) = (scene(), first_input());
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    for effect in [-0.1, 1.1, f64::NAN] {
        let refused = core.frame(&input.clone().with_effect(effect));
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("effect"), "{message}");
    }
}

/// An app's own device, a core on it, and targets to draw on.
pub(crate) struct App {
    pub(crate) core: Core,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
}

impl App {
    pub(crate) fn open() -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let opened = pollster::block_on(adapter.unwrap().request_device(&wgpu::DeviceDescriptor {
            required_limits: phone_limits(),
            ..Default::default()
        }));
        let (device, queue) = opened.unwrap();
        Self {
            core: Core::on_device(device.clone(), queue.clone()).unwrap(),
            device,
            queue,
        }
    }

    /// The core's drawing on a target of a screen's size, as red, green, blue and alpha.
    fn shown(&mut self, [width, height]: [u32; 2], display: Display) -> Vec<u8> {
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let target = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("screen"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        self.core.draw_on(&target, display).unwrap();
        let row_bytes = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("copy"),
            size: u64::from(row_bytes) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes),
            rows_per_image: None,
        };
        let into = wgpu::TexelCopyBufferInfo {
            buffer: &copy,
            layout,
        };
        encoder.copy_texture_to_buffer(target.as_image_copy(), into, size);
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let bytes = copy.get_mapped_range(..).unwrap();
        let rows = bytes.chunks_exact(row_bytes as usize);
        rows.flat_map(|row| row[..4 * width as usize].to_vec()).collect()
    }
}

/// A screen shows planes like their pixels, with the region over them in full, in part and not at
/// all.
#[test]
fn a_screen_shows_planes_as_their_pixels() {
    let (scene, input) = (scene(), first_input());
    let mut app = App::open();
    let planes = CameraImage::from(planar(input.image.rgba(), BT601_FULL).unwrap());
    let pixels = CameraImage::Rgba(planes.rgba().clone());
    for (preset, effect) in [
        (Preset::Balanced, 1.0),
        (Preset::Balanced, 0.4),
        (Preset::Balanced, 0.0),
        (Preset::Paper, 1.0),
    ] {
        app.core.set_scene(scene.clone(), preset).unwrap();
        for screen_px in [[scene.width_px, scene.height_px], [333, 197]] {
            let [of_planes, of_pixels] = [&planes, &pixels].map(|image| {
                let image = image.clone();
                let input = input.clone().with_image(image).with_effect(effect);
                app.core.frame(&input).unwrap();
                app.shown(screen_px, Display::default())
            });
            // The error of an 8-bit sampler is two codes in chroma, and planes are filtered as
            // codes rather than as light.
            let pairs = of_planes.iter().zip(&of_pixels);
            let far = pairs.filter(|(a, b)| a.abs_diff(**b) > 3).count();
            let (most, n) = (worst(&of_planes, &of_pixels), of_planes.len());
            assert!(
                far * 100 < n,
                "{preset} {effect} {screen_px:?}: {far} of {n} codes, at most {most}"
            );
        }
    }
}

/// On a screen of its own size a picture equals the one that is read back, rotated or not, with its
/// effect in full or in part.
#[test]
fn a_screen_shows_the_region_over_the_camera_image() {
    let (scene, input) = (scene(), first_input());
    let mut app = App::open();
    app.core.set_scene(scene, Preset::Balanced).unwrap();
    for (effect, quarter_turns) in [(1.0, 0), (1.0, 1), (1.0, 2), (1.0, 3), (0.4, 0), (0.0, 0)] {
        app.core.frame(&input.clone().with_effect(effect)).unwrap();
        let read = app.core.read_picture().unwrap();
        let changed = worst(&read.rgba8, &input.image.rgba().rgba8);
        assert_eq!(changed > 10, effect > 0.0, "effect {effect}: {changed}");
        let image_px = [read.width_px, read.height_px];
        let [width, height] = if quarter_turns % 2 == 0 {
            image_px
        } else {
            [image_px[1], image_px[0]]
        };
        let display = Display {
            quarter_turns,
            ..Display::default()
        };
        let map = display.image_from_screen(image_px, [width, height]);
        let expected: Vec<u8> = (0..height)
            .flat_map(|y| (0..width).map(move |x| DVec2::new(f64::from(x), f64::from(y)) + 0.5))
            .flat_map(|at| {
                let texel = map.transform_point2(at).floor().as_uvec2();
                let first = 4 * (texel.y * image_px[0] + texel.x) as usize;
                read.rgba8[first..first + 4].to_vec()
            })
            .collect();
        // Blended before or after rounding.
        let most = worst(&app.shown([width, height], display), &expected);
        assert!(most <= 1, "effect {effect}, {quarter_turns} turns: {most}");
    }
}

/// In every rotation and fit each point of the screen shows the picture's point given by the map,
/// and black outside the picture.
#[test]
fn a_screen_shows_the_picture_turned_and_cropped() {
    let (scene, input) = (scene(), first_input());
    let mut app = App::open();
    app.core.set_scene(scene.clone(), Preset::Balanced).unwrap();
    let image_px = [scene.width_px, scene.height_px];
    // A test picture whose red encodes the column, and whose green encodes the row.
    let rgba8 = (0..image_px[1]).flat_map(|y| (0..image_px[0]).map(move |x| [x, y]));
    let rgba8: Vec<u8> = rgba8
        .flat_map(|[x, y]| [x.min(255) as u8, (2 * y).min(255) as u8, 40, 255])
        .collect();
    let image = Image {
        width_px: image_px[0],
        height_px: image_px[1],
        rgba8,
    };
    let shown_pose = scene.physical_pose.clone();
    app.core
        .frame(&input.with_image(image.clone()).with_shown_pose(shown_pose))
        .unwrap();
    for quarter_turns in 0..4 {
        for fit in [Fit::Fill, Fit::Whole] {
            for screen_px in [image_px, [90, 200], [333, 97]] {
                let display = Display { quarter_turns, fit };
                let screen = app.shown(screen_px, display);
                let map = display.image_from_screen(image_px, screen_px);
                let mut n_black = 0;
                for (index, pixel) in screen.chunks_exact(4).enumerate() {
                    let index = u32::try_from(index).unwrap();
                    let at =
                        DVec2::new(f64::from(index % screen_px[0]), f64::from(index / screen_px[0])) + 0.5;
                    let on_image = map.transform_point2(at);
                    let size = DVec2::from(image_px.map(f64::from));
                    let beyond = (-on_image).max(on_image - size).max_element();
                    if beyond.abs() < 0.02 {
                        continue;
                    }
                    if beyond > 0.0 {
                        n_black += 1;
                        assert_eq!(pixel, [0, 0, 0, 255], "{display:?} {screen_px:?} at {at}");
                        continue;
                    }
                    // A pixel's centre is half a pixel from its border; filtering is linear in light, which bends the codes.
                    let expected = (on_image - 0.5).clamp(DVec2::ZERO, size - 1.0) * DVec2::new(1.0, 2.0);
                    let actual = DVec2::new(f64::from(pixel[0]), f64::from(pixel[1]));
                    let error = (actual - expected).abs().max_element();
                    assert!(
                        error < 1.6,
                        "{display:?} {screen_px:?} at {at}: {actual}, not {expected}"
                    );
                }
                let is_cropped = fit == Fit::Fill;
                let is_same = quarter_turns % 2 == 0 && screen_px == image_px;
                assert_eq!(n_black == 0, is_cropped || is_same, "{display:?} {screen_px:?}");
                if is_same && quarter_turns == 0 {
                    assert!(screen == image.rgba8, "code for code");
                }
            }
        }
    }
}

/// An input that is refused by name changes nothing that is shown.
#[test]
fn a_refused_input_leaves_the_preview() {
    let (scene, input) = (scene(), first_input());
    let screen_px = [scene.width_px, scene.height_px];
    let mut app = App::open();
    app.core.set_scene(scene, Preset::Balanced).unwrap();
    app.core.frame(&input).unwrap();
    let mut dark = input.image.rgba().as_ref().clone();
    dark.rgba8
        .chunks_exact_mut(4)
        .for_each(|pixel| pixel[..3].fill(9));
    app.core.show_camera(&dark.clone().into()).unwrap();
    let preview = app.shown(screen_px, Display::default());
    let mut cut = dark;
    cut.rgba8.pop();
    for refused in [input.clone().with_effect(2.0), input.with_image(cut)] {
        assert!(app.core.frame(&refused).is_err());
        assert!(app.shown(screen_px, Display::default()) == preview);
    }
}
