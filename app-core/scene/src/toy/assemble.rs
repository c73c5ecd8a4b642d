//! Builds a toy from a file: reads each part and selects the drawn surfaces.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

use glam::DAffine3;
use gltf::json::mesh::{Mesh, Primitive};

use super::accessor::Source;
use super::check::{check_count, check_limit};
use super::container::{self, get};
use super::cut::{self, Looks, Shape};
use super::error::{Flaw, ToyProblem};
use super::geometry::{self, Geometry};
use super::limits::{MAX_INDICES, MAX_TRIANGLES, MAX_VERTICES};
use super::material::{self, Material, tex_coord};
use super::outward::turn_outward;
use super::rig::{Rig, RigPose, Set};
use super::shadow_indices::ShadowIndices;
use super::surface::{Surface, is_mirrored, lay_out};
use super::warning::ToyWarning;
use super::{Toy, clip, graph, instances, mirrored, skin};

pub(super) fn assemble(file: &str, bytes: &[u8]) -> Result<Toy, Flaw> {
    let mut warnings = Vec::new();
    let mut container = container::open(bytes, &mut warnings)?;
    instances::expand(&mut container)?;
    let source = Source::new(&container);
    let mut graph = graph::read(source.root, &mut warnings)?;
    let clips = clip::read(&source, &mut graph, &container.extras.broken_clips, &mut warnings);
    let rig = Rig {
        skins: skin::read_skins(&source)?,
        graph,
        clips,
    };
    let (mut geometries, mut surfaces) = read_scene(&source, &rig, &mut warnings)?;

    // Primitives without a material have an index of one past the last of the file.
    let mut is_used = vec![false; source.root.materials.len() + 1];
    surfaces
        .iter()
        .for_each(|surface| is_used[surface.material] = true);
    let (mut materials, textures) = material::read(&source, &is_used, &mut warnings)?;
    if is_used[materials.len()] {
        materials.push(Material::DEFAULT);
    }
    let mut shape = Shape {
        rig: &rig,
        rest: &rig.pose(&Set::Authored, DAffine3::IDENTITY),
        geometries: &mut geometries,
        surfaces: &mut surfaces,
    };
    let looks = Looks {
        materials: &materials,
        textures: &textures,
    };
    cut::apply(&mut shape, &looks, &mut warnings);
    let is_mirrored = mirrored::by_clips(&rig, &geometries, &surfaces, &mut warnings);
    let draws = lay_out(&surfaces, &geometries);
    let shadow_indices = ShadowIndices::new(&surfaces, &geometries, &draws.indices, &is_mirrored);
    if shadow_indices.indices.is_empty() {
        return Err(ToyProblem::NoTriangles.at("meshes"));
    }
    Ok(Toy {
        file: file.to_owned(),
        rig: Arc::new(rig),
        shadow_indices: Arc::new(shadow_indices),
        casters: OnceLock::new(),
        welded: Arc::default(),
        geometries,
        surfaces: surfaces.into(),
        draws: Arc::new(draws),
        materials,
        textures: textures.into(),
        warnings,
    })
}

/// Reads the drawn surfaces of the scene; fails if there are none.
fn read_scene(
    source: &Source,
    rig: &Rig,
    warnings: &mut Vec<ToyWarning>,
) -> Result<(Vec<Geometry>, Vec<Surface>), Flaw> {
    let mut scene = SceneReader {
        source,
        rig,
        rest: rig.pose(&Set::Authored, DAffine3::IDENTITY),
        meshes: HashMap::new(),
        geometries: Vec::new(),
        surfaces: Vec::new(),
        n_vertices: 0,
        n_indices: 0,
    };
    for node in graph::scene_nodes(source.root)? {
        scene.add_node(node, warnings)?;
    }
    if scene.surfaces.is_empty() {
        return Err(ToyProblem::NoTriangles.at("meshes"));
    }
    let n_vertices = scene
        .geometries
        .iter()
        .flat_map(|g| &g.influences)
        .map(|i| i.n_repaired)
        .sum();
    if n_vertices > 0 {
        warnings.push(ToyWarning::WeightsRepaired { n_vertices });
    }
    Ok((scene.geometries, scene.surfaces))
}

/// Walks the scene and reads each mesh with its first node.
struct SceneReader<'a> {
    source: &'a Source<'a>,
    rig: &'a Rig,
    rest: RigPose,
    meshes: HashMap<usize, Rc<[Drawable]>>,
    geometries: Vec<Geometry>,
    surfaces: Vec<Surface>,
    n_vertices: usize,
    n_indices: usize,
}

/// A primitive of a mesh.
struct Drawable {
    geometry: usize,
    material: usize,
    field: String,
}

impl SceneReader<'_> {
    fn add_node(&mut self, node: usize, warnings: &mut Vec<ToyWarning>) -> Result<(), Flaw> {
        let root = self.source.root;
        let (json, field) = (&root.nodes[node], format!("nodes[{node}]"));
        let Some(mesh) = json.mesh else { return Ok(()) };
        let drawables = match self.meshes.get(&mesh.value()) {
            Some(drawables) => Rc::clone(drawables),
            None => {
                let drawables = self.read_mesh(get(root, &field, mesh, "mesh")?, mesh.value(), warnings)?;
                Rc::clone(self.meshes.entry(mesh.value()).or_insert(drawables.into()))
            }
        };
        if let Some(skin) = json.skin {
            get(root, &field, skin, "skin")?;
        }
        let skin = json.skin.map(|skin| skin.value());
        drawables
            .iter()
            .try_for_each(|drawable| self.add_surface(node, skin, drawable, warnings))
    }

    fn read_mesh(
        &mut self,
        mesh: &Mesh,
        index: usize,
        warnings: &mut Vec<ToyWarning>,
    ) -> Result<Vec<Drawable>, Flaw> {
        let n_targets = graph::n_morph_targets(mesh);
        let first = self.geometries.len();
        let mut drawables = Vec::new();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let field = format!("meshes[{index}].primitives[{i}]");
            let found = primitive.targets.as_ref().map_or(0, Vec::len);
            check_count("morph targets", found, n_targets, &field)?;
            let (material, tex_coord) = self.material(&field, primitive)?;
            match geometry::read(self.source, &field, primitive, tex_coord, warnings)? {
                Some(geometry) if geometry.indices.is_empty() => {}
                Some(geometry) => {
                    self.geometries.push(geometry);
                    drawables.push(Drawable {
                        geometry: self.geometries.len() - 1,
                        material,
                        field,
                    });
                }
                None => warnings.push(ToyWarning::PrimitiveSkipped { field }),
            }
        }
        let fields: Vec<String> = drawables.iter().map(|drawable| drawable.field.clone()).collect();
        turn_outward(&mut self.geometries[first..], &fields, warnings);
        Ok(drawables)
    }

    /// The material of a primitive, and the texture coordinates it reads.
    fn material(&self, field: &str, primitive: &Primitive) -> Result<(usize, u32), Flaw> {
        let root = self.source.root;
        match primitive.material {
            Some(index) => Ok((index.value(), tex_coord(get(root, field, index, "material")?))),
            None => Ok((root.materials.len(), 0)),
        }
    }

    fn add_surface(
        &mut self,
        node: usize,
        skin: Option<usize>,
        drawable: &Drawable,
        warnings: &mut Vec<ToyWarning>,
    ) -> Result<(), Flaw> {
        let field = &drawable.field;
        let geometry = &self.geometries[drawable.geometry];
        match (skin, &geometry.influences) {
            (Some(skin), Some(influences)) => {
                let (needed, n) = (influences.n_joints_needed(), self.rig.skins[skin].joints.len());
                if needed > n {
                    let problem = ToyProblem::NoSuch {
                        what: "joint",
                        index: needed - 1,
                        n,
                    };
                    return Err(problem.at(format!("{field}.attributes.JOINTS with skins[{skin}]")));
                }
            }
            (Some(_), None) => warnings.push(ToyWarning::SkinIgnored { field: field.clone() }),
            (None, _) => {}
        }
        let first_vertex = self.n_vertices;
        self.n_vertices = check_limit(
            "vertices",
            first_vertex + geometry.positions.len(),
            MAX_VERTICES,
            field,
        )?;
        self.n_indices = check_limit(
            "indices",
            self.n_indices + geometry.indices.len(),
            MAX_INDICES,
            field,
        )?;
        check_limit("triangles", self.n_indices / 3, MAX_TRIANGLES, field)?;
        let (geometry_index, material) = (drawable.geometry, drawable.material);
        let surface = Surface {
            geometry: geometry_index,
            node,
            skin,
            material,
            first_vertex,
            is_mirrored: false,
        };
        let is_mirrored = is_mirrored(&surface, geometry, &self.rest);
        self.surfaces.push(Surface {
            is_mirrored,
            ..surface
        });
        Ok(())
    }
}
