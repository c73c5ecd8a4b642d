//! Materials: the base colour, the factor of the fitted light.

use gltf::json::Index;
use gltf::json::material::{AlphaMode, Material as JsonMaterial};
use gltf::json::texture::WrappingMode;

use super::accessor::Source;
use super::check::{check_limit, check_range};
use super::container::{allowed, get};
use super::error::Flaw;
use super::extensions::way_out;
use super::limits::{COLOR, FACTOR, MAX_MATERIALS};
use super::texture::{Texture, TextureStore};
use super::warning::ToyWarning;

/// Appearance of a surface: the base colour of the metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Linear RGBA, from 0 to 1; multiplies the texture and the vertex colour.
    pub base_color_linear: [f32; 4],
    /// The texture, if there is one.
    pub base_color_texture: Option<MaterialTexture>,
    /// Whether the back faces are visible.
    pub double_sided: bool,
    /// Its use of alpha.
    pub(super) alpha: Alpha,
}

/// The effect of alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Alpha {
    /// All is opaque.
    Opaque,
    /// Parts with at least this alpha are opaque, others invisible.
    Mask(f32),
    /// All parts are visible, and transparent by alpha.
    Blend,
}

impl Material {
    /// glTF's default for a primitive without a material.
    pub(super) const DEFAULT: Self = Self {
        base_color_linear: [1.0; 4],
        base_color_texture: None,
        double_sided: false,
        alpha: Alpha::Opaque,
    };
}

/// A texture in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialTexture {
    /// Index into [`Toy::textures`](super::Toy::textures).
    pub texture: usize,
    /// Addressing of u beyond 0 to 1.
    pub wrap_u: Wrap,
    /// Addressing of v beyond 0 to 1.
    pub wrap_v: Wrap,
}

/// Addressing of a texture beyond its border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The texture repeats.
    Repeat,
    /// The texture repeats, every other time mirrored.
    MirroredRepeat,
    /// The border texels repeat.
    ClampToEdge,
}

impl From<WrappingMode> for Wrap {
    fn from(mode: WrappingMode) -> Self {
        match mode {
            WrappingMode::Repeat => Self::Repeat,
            WrappingMode::MirroredRepeat => Self::MirroredRepeat,
            WrappingMode::ClampToEdge => Self::ClampToEdge,
        }
    }
}

/// The crate's value for a texture without a source.
const NO_SOURCE: usize = u32::MAX as usize;

/// The coordinate set of a material's base colour.
pub(super) fn tex_coord(material: &JsonMaterial) -> u32 {
    material
        .pbr_metallic_roughness
        .base_color_texture
        .as_ref()
        .map_or(0, |texture| texture.tex_coord)
}

/// Reads all materials; decodes the pictures of those that `is_used`.
pub(super) fn read(
    source: &Source,
    is_used: &[bool],
    warnings: &mut Vec<ToyWarning>,
) -> Result<(Vec<Material>, Vec<Texture>), Flaw> {
    check_limit(
        "materials",
        source.root.materials.len(),
        MAX_MATERIALS,
        "materials",
    )?;
    let mut store = TextureStore::new(source);
    let mut materials = Vec::with_capacity(source.root.materials.len() + 1);
    for (i, (material, &is_used)) in source.root.materials.iter().zip(is_used).enumerate() {
        let field = format!("materials[{i}].pbrMetallicRoughness");
        let base = &material.pbr_metallic_roughness;
        let written = base.base_color_factor.0;
        let factor_field = format!("{field}.baseColorFactor");
        check_range(&factor_field, &written, 4, &COLOR)?;
        let base_color_linear = written.map(|factor| factor.clamp(*FACTOR.start(), *FACTOR.end()));
        if base_color_linear != written {
            let field = factor_field;
            warnings.push(ToyWarning::FactorClamped { field });
        }
        let field = format!("{field}.baseColorTexture");
        let base_color_texture = match &base.base_color_texture {
            Some(info) if is_used => texture(&mut store, &field, info.index, warnings)?,
            _ => None,
        };
        materials.push(Material {
            base_color_linear,
            base_color_texture,
            double_sided: material.double_sided,
            alpha: alpha(material, i)?,
        });
    }
    Ok((materials, store.textures))
}

fn alpha(material: &JsonMaterial, i: usize) -> Result<Alpha, Flaw> {
    let cutoff = material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
    check_range(&format!("materials[{i}].alphaCutoff"), &[cutoff], 1, &COLOR)?;
    Ok(
        match allowed(material.alpha_mode, &format!("materials[{i}].alphaMode"))? {
            AlphaMode::Opaque => Alpha::Opaque,
            AlphaMode::Mask => Alpha::Mask(cutoff),
            AlphaMode::Blend => Alpha::Blend,
        },
    )
}

fn texture(
    store: &mut TextureStore,
    field: &str,
    index: Index<gltf::json::Texture>,
    warnings: &mut Vec<ToyWarning>,
) -> Result<Option<MaterialTexture>, Flaw> {
    let root = store.source.root;
    let texture = get(root, field, index, "texture")?;
    let field = format!("textures[{}]", index.value());
    let (wrap_u, wrap_v) = match texture.sampler {
        Some(index) => {
            let sampler = get(root, &field, index, "sampler")?;
            let field = format!("samplers[{}]", index.value());
            (
                allowed(sampler.wrap_s, &field)?.into(),
                allowed(sampler.wrap_t, &field)?.into(),
            )
        }
        None => (Wrap::Repeat, Wrap::Repeat),
    };
    if texture.source.value() == NO_SOURCE {
        warnings.push(match store.source.unread_texture(index.value()) {
            Some(format) => ToyWarning::FormatIgnored {
                field,
                format,
                way_out: way_out(format),
            },
            None => ToyWarning::TextureIgnored { field },
        });
        return Ok(None);
    }
    let image = get(root, &field, texture.source, "image")?;
    let texture = store.texture(texture.source.value(), image, warnings)?;
    Ok(texture.map(|texture| MaterialTexture {
        texture,
        wrap_u,
        wrap_v,
    }))
}
