//! Materials: the base colour, the factor of the fitted light.

use gltf::json::texture::WrappingMode;
use gltf::json::{Index, material::Material as JsonMaterial};

use super::accessor::Source;
use super::check::{check_limit, check_range};
use super::container::{allowed, get};
use super::error::{Flaw, ToyWarning};
use super::limits::{FACTOR, MAX_MATERIALS};
use super::texture::{Texture, TextureStore};

/// Appearance of a surface: the base colour of the metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Linear RGBA, from 0 to 1; multiplies the texture and the vertex colour.
    pub base_color_linear: [f32; 4],
    /// The texture, where there is one.
    pub base_color_texture: Option<MaterialTexture>,
    /// Whether the back faces are seen too.
    pub double_sided: bool,
}

impl Material {
    /// The default of glTF where a primitive names no material.
    pub(super) const DEFAULT: Self = Self {
        base_color_linear: [1.0; 4],
        base_color_texture: None,
        double_sided: false,
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
    /// The same again.
    Repeat,
    /// The same, every other time in reverse.
    MirroredRepeat,
    /// The texels of the border.
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

/// The texture coordinate set that a material's base colour reads.
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
        let base_color_linear = base.base_color_factor.0;
        let factor_field = format!("{field}.baseColorFactor");
        check_range(&factor_field, &base_color_linear, 4, &FACTOR)?;
        let field = format!("{field}.baseColorTexture");
        let base_color_texture = match &base.base_color_texture {
            Some(info) if is_used => texture(&mut store, &field, info.index, warnings)?,
            _ => None,
        };
        materials.push(Material {
            base_color_linear,
            base_color_texture,
            double_sided: material.double_sided,
        });
    }
    Ok((materials, store.textures))
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
    let image = get(root, &field, texture.source, "image")?;
    let texture = store.texture(texture.source.value(), image, warnings)?;
    Ok(texture.map(|texture| MaterialTexture {
        texture,
        wrap_u,
        wrap_v,
    }))
}
