//! Planes that a platform shares as textures: read in place, and copied for the processor alone.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use app_core::camera_frame::{CameraImage, PlanarImage, PlaneError, Planes};
use app_core::gpu::{LentError, LentTextures};
use app_core::preset::Preset;
use app_core::wgpu;

use measure::planar::{BT601_FULL, planar};

use crate::core::bundled::{first_input, scene};
use crate::core::camera::App;

/// A texture of a platform, with its texels.
fn texture(app: &App, size_px: [u32; 2], format: wgpu::TextureFormat, texels: &[u8]) -> wgpu::Texture {
    let size = wgpu::Extent3d {
        width: size_px[0],
        height: size_px[1],
        depth_or_array_layers: 1,
    };
    let texture = app.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("lent"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: format.block_copy_size(None).map(|bytes| bytes * size_px[0]),
        rows_per_image: None,
    };
    app.queue
        .write_texture(texture.as_image_copy(), texels, layout, size);
    texture
}

fn copy(image: &PlanarImage) -> PlanarImage {
    let [width, height] = image.size_px();
    let row = |width: u32| width as usize;
    let planes = Planes::nv12(
        [width, height],
        (image.luma(), row(width)),
        (image.chroma(), 2 * row(width.div_ceil(2))),
        image.encoding(),
    );
    PlanarImage::new(&planes).unwrap()
}

/// `image` with its planes on the device of `app`, and the number of their copies.
fn lent(app: &App, image: &Arc<PlanarImage>) -> (Result<PlanarImage, LentError>, Arc<AtomicU32>) {
    let size_px = image.size_px();
    let half_px = size_px.map(|side| side.div_ceil(2));
    let n_copies = Arc::new(AtomicU32::new(0));
    let (original, counted) = (Arc::clone(image), Arc::clone(&n_copies));
    let planes = LentTextures {
        device: app.core.device().unwrap(),
        luma: texture(app, size_px, wgpu::TextureFormat::R8Unorm, image.luma()),
        chroma: texture(app, half_px, wgpu::TextureFormat::Rg8Unorm, image.chroma()),
        read: Box::new(move || {
            counted.fetch_add(1, Ordering::Relaxed);
            Some(copy(&original))
        }),
    };
    (planes.into_image(size_px, image.encoding()), n_copies)
}

fn picture(app: &mut App, image: CameraImage) -> Vec<u8> {
    app.core.set_scene(scene(), Preset::Balanced).unwrap();
    let input = first_input().with_image(image);
    app.core.frame(&input).unwrap();
    app.core.read_picture().unwrap().rgba8
}

#[test]
fn lent_textures_give_the_picture_of_their_bytes_without_a_copy() {
    let mut app = App::open();
    let original = Arc::new(planar(first_input().image.rgba(), BT601_FULL).unwrap());
    let expected = picture(&mut app, CameraImage::Planes(Arc::clone(&original)));
    let (image, n_copies) = lent(&app, &original);
    let image = CameraImage::from(image.unwrap());
    assert!(picture(&mut app, image.clone()) == expected, "another picture");
    assert_eq!(
        n_copies.load(Ordering::Relaxed),
        0,
        "planes were copied to be drawn"
    );
    assert!(image.kept().rgba().rgba8 == original.rgba().rgba8);
    assert_eq!(n_copies.load(Ordering::Relaxed), 1);
}

#[test]
fn textures_of_a_lost_device_are_read_as_bytes() {
    let [mut app, lost] = [App::open(), App::open()];
    let original = Arc::new(planar(first_input().image.rgba(), BT601_FULL).unwrap());
    let expected = picture(&mut app, CameraImage::Planes(Arc::clone(&original)));
    let (image, n_copies) = lent(&lost, &original);
    drop(lost);
    assert!(
        picture(&mut app, image.unwrap().into()) == expected,
        "another picture"
    );
    assert_eq!(n_copies.load(Ordering::Relaxed), 1);
}

#[test]
fn what_cannot_be_read_is_black() {
    let app = App::open();
    let original = Arc::new(planar(first_input().image.rgba(), BT601_FULL).unwrap());
    let (width, height) = (original.size_px()[0], original.size_px()[1]);
    let image = |read: fn() -> Option<PlanarImage>| {
        let planes = LentTextures {
            device: app.core.device().unwrap(),
            luma: texture(
                &app,
                [width, height],
                wgpu::TextureFormat::R8Unorm,
                original.luma(),
            ),
            chroma: texture(
                &app,
                [width.div_ceil(2), height.div_ceil(2)],
                wgpu::TextureFormat::Rg8Unorm,
                original.chroma(),
            ),
            read: Box::new(read),
        };
        planes.into_image([width, height], BT601_FULL).unwrap()
    };
    let of_other_size = || PlanarImage::new(&Planes::nv12([1, 1], (&[9], 1), (&[9, 9], 2), BT601_FULL)).ok();
    for read in [(|| None) as fn() -> Option<PlanarImage>, of_other_size] {
        let codes = image(read).rgba().rgba8.clone();
        assert!(codes.chunks(4).all(|pixel| pixel == [0, 0, 0, 255]));
        assert_eq!(codes.len(), 4 * (width * height) as usize);
    }
}

#[test]
fn a_texture_that_is_not_its_plane_is_refused() {
    let app = App::open();
    let [luma, chroma] = [
        (wgpu::TextureFormat::R8Unorm, [8, 6], vec![0; 48]),
        (wgpu::TextureFormat::Rg8Unorm, [4, 3], vec![0; 24]),
    ]
    .map(|(format, size_px, texels)| texture(&app, size_px, format, &texels));
    let lent = |size_px, luma: &wgpu::Texture, chroma: &wgpu::Texture| {
        let planes = LentTextures {
            device: app.core.device().unwrap(),
            luma: luma.clone(),
            chroma: chroma.clone(),
            read: Box::new(|| None),
        };
        planes.into_image(size_px, BT601_FULL).map(drop)
    };
    assert_eq!(lent([8, 6], &luma, &chroma), Ok(()));
    assert_eq!(
        lent([8, 5], &luma, &chroma).unwrap_err().to_string(),
        "camera planes, luma: a texture of 8 x 6 px, R8Unorm; 8 x 5 px, R8Unorm is needed"
    );
    assert_eq!(
        lent([8, 6], &luma, &luma).unwrap_err().to_string(),
        "camera planes, Cb and Cr: a texture of 8 x 6 px, R8Unorm; 4 x 3 px, Rg8Unorm is needed"
    );
    assert!(matches!(
        lent([0, 6], &luma, &chroma),
        Err(LentError::Planes(PlaneError::Size { .. }))
    ));
}
