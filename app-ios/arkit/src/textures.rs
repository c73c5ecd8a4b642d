//! The camera's planes as Metal textures, without a copy.
//!
//! A texture keeps its pixel buffer until Metal has finished with it, and so does the picture:
//! ARKit has few buffers, so a caller that keeps several pictures copies them
//! ([`CameraImage::kept`](app_core::camera_frame::CameraImage::kept)).

use std::ptr::{self, NonNull};

use app_core::camera_frame::PlanarImage;
use app_core::gpu::{DeviceHandle, LentTextures};
use app_core::wgpu::{self, TextureFormat, hal};
use objc2_core_foundation::{CFRetained, Type};
use objc2_core_video::{
    CVMetalTexture, CVMetalTextureCache, CVMetalTextureGetTexture, CVPixelBuffer, CVPixelBufferGetHeight,
    CVPixelBufferGetPixelFormatType, CVPixelBufferGetPlaneCount, CVPixelBufferGetWidth,
};
use objc2_metal::{MTLPixelFormat, MTLTextureType};

use super::{frame, pixels};

/// Owner of memory that Metal reads.
struct Kept<T>(CFRetained<T>);

// SAFETY: Core Foundation counts references atomically, pixel buffers and their textures may be
// used and released by any thread, and nothing writes to a buffer that was delivered with a frame.
unsafe impl<T> Send for Kept<T> {}
// SAFETY: as above.
unsafe impl<T> Sync for Kept<T> {}

/// Creates textures of pixel buffers on the core's device.
pub(super) struct TextureCache {
    device: DeviceHandle,
    cache: CFRetained<CVMetalTextureCache>,
}

impl TextureCache {
    /// Returns `None` if the device is not Metal's, or has no memory.
    pub(super) fn new(device: DeviceHandle) -> Option<Self> {
        let mut cache = ptr::null_mut();
        // SAFETY: the device is not destroyed during the access; the cache retains what it needs of
        // it. The created object is owned.
        let cache = unsafe {
            let metal = device.raw().as_hal::<hal::api::Metal>()?;
            let out = NonNull::from(&mut cache);
            let status = CVMetalTextureCache::create(None, None, metal.raw_device(), None, out);
            CFRetained::from_raw(NonNull::new(cache).filter(|_| status == 0)?)
        };
        Some(Self { device, cache })
    }

    /// The picture of a frame's pixel buffer; `None` if it does not consist of luma and chroma, or
    /// if Metal refuses it.
    pub(super) fn lend(&self, buffer: &CVPixelBuffer) -> Option<PlanarImage> {
        let encoding = frame::encoding(CVPixelBufferGetPixelFormatType(buffer)).ok()?;
        let size = [CVPixelBufferGetWidth(buffer), CVPixelBufferGetHeight(buffer)];
        let size_px = [u32::try_from(size[0]).ok()?, u32::try_from(size[1]).ok()?];
        if CVPixelBufferGetPlaneCount(buffer) != 2 {
            return None;
        }
        let half_px = size_px.map(|side| side.div_ceil(2));
        let luma = (MTLPixelFormat::R8Unorm, TextureFormat::R8Unorm);
        let chroma = (MTLPixelFormat::RG8Unorm, TextureFormat::Rg8Unorm);
        let kept = Kept(buffer.retain());
        let planes = LentTextures {
            device: self.device.clone(),
            luma: self.texture((buffer, 0), size_px, luma)?,
            chroma: self.texture((buffer, 1), half_px, chroma)?,
            read: Box::new(move || pixels::copied(kept.buffer())),
        };
        planes.into_image(size_px, encoding).ok()
    }

    /// One plane of a buffer.
    fn texture(
        &self,
        (buffer, plane): (&CVPixelBuffer, usize),
        [width, height]: [u32; 2],
        (metal_format, format): (MTLPixelFormat, TextureFormat),
    ) -> Option<wgpu::Texture> {
        let mut made: *mut CVMetalTexture = ptr::null_mut();
        let (columns, rows) = (width as usize, height as usize);
        // SAFETY: cache and buffer live, the plane is one of two, and Metal checks the size. The
        // created object is owned.
        let made = unsafe {
            let out = NonNull::from(&mut made);
            let status = CVMetalTextureCache::create_texture_from_image(
                None,
                &self.cache,
                buffer,
                None,
                metal_format,
                columns,
                rows,
                plane,
                out,
            );
            CFRetained::from_raw(NonNull::new(made).filter(|_| status == 0)?)
        };
        let raw = CVMetalTextureGetTexture(&made)?;
        let kept = Kept(made);
        let done = Box::new(move || drop(kept));
        let size = hal::CopyExtent {
            width,
            height,
            depth: 1,
        };
        let descriptor = wgpu::TextureDescriptor {
            label: Some("lent"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        // SAFETY: the texture belongs to this device, has one level and layer, is filled by the
        // camera, and matches its description.
        Some(unsafe {
            let texture = hal::metal::Device::texture_from_raw(
                raw,
                format,
                MTLTextureType::Type2D,
                1,
                1,
                size,
                Some(done),
            );
            let state = wgpu::TextureUses::RESOURCE;
            let device = self.device.raw();
            device.create_texture_from_hal::<hal::api::Metal>(texture, &descriptor, state)
        })
    }
}

impl Kept<CVPixelBuffer> {
    fn buffer(&self) -> &CVPixelBuffer {
        &self.0
    }
}
