//! The node tree: placements of meshes, lights and cameras.

use std::collections::HashMap;

use glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};
use gltf::json::Node;

use super::document::Document;
use super::materials::Materials;
use super::{lights, primitives};
use crate::description::CameraDescription;
use crate::description::geometry::GltfGeometry;
use crate::error::SceneError;
use crate::import::importer::Importer;

/// A walk over the nodes of a scene.
pub(super) struct Walk<'a> {
    document: &'a Document<'a>,
    entry: &'a GltfGeometry,
    /// Index of the entry in `geometry`.
    entry_index: usize,
    materials: Materials,
    /// Meshes of the geometry by mesh of the file.
    meshes: HashMap<usize, Vec<usize>>,
}

/// A node to visit.
struct Step {
    node: usize,
    parent: DAffine3,
    depth: usize,
    /// Where it is named, for messages.
    location: String,
}

impl<'a> Walk<'a> {
    pub(super) fn new(
        document: &'a Document<'a>,
        entry: &'a GltfGeometry,
        entry_index: usize,
    ) -> Self {
        Self {
            document,
            entry,
            entry_index,
            materials: Materials::default(),
            meshes: HashMap::new(),
        }
    }

    /// Visits every node of the scene once.
    pub(super) fn run(
        &mut self,
        importer: &mut Importer,
        world_from_file: DAffine3,
    ) -> Result<(), SceneError> {
        let document = self.document;
        let (file, root) = (document.file, document.root);
        let mut visited = vec![false; root.nodes.len()];
        let mut steps = self.roots(importer, world_from_file)?;
        while let Some(step) = steps.pop() {
            let node = file.element(&root.nodes, "nodes", step.node, &step.location)?;
            if std::mem::replace(&mut visited[step.node], true) {
                let message = format!(
                    "nodes[{}] is reached twice: a cycle or two parents",
                    step.node
                );
                return Err(file.refused(step.location, message));
            }
            let depth = step.depth + 1;
            if depth > importer.limits.node_depth {
                let message = format!(
                    "nodes are nested deeper than {}",
                    importer.limits.node_depth
                );
                return Err(file.refused(step.location, message));
            }
            let location = format!("nodes[{}]", step.node);
            let world = step.parent * self.local(node, &location)?;
            if !world.is_finite() {
                return Err(file.refused(location, "the transform is not finite"));
            }
            self.place(importer, node, &location, &world)?;
            let children = node.children.as_deref().unwrap_or_default().iter();
            // Last in, first out: reversed, so that the file's order is kept.
            steps.extend(children.enumerate().rev().map(|(i, child)| Step {
                node: child.value(),
                parent: world,
                depth,
                location: format!("{location}.children[{i}]"),
            }));
        }
        Ok(())
    }

    /// The top nodes of the default scene, or of the first, or all nodes without a parent.
    fn roots(&self, importer: &mut Importer, parent: DAffine3) -> Result<Vec<Step>, SceneError> {
        let (file, root) = (self.document.file, self.document.root);
        let step = |(node, location)| Step {
            node,
            parent,
            depth: 0,
            location,
        };
        let index = root.scene.map_or(0, |scene| scene.value());
        if root.scene.is_some() || !root.scenes.is_empty() {
            let scene = file.element(&root.scenes, "scenes", index, "scene")?;
            let nodes = scene.nodes.iter().enumerate();
            let named =
                nodes.map(|(i, node)| (node.value(), format!("scenes[{index}].nodes[{i}]")));
            let mut steps: Vec<Step> = named.map(step).collect();
            steps.reverse();
            return Ok(steps);
        }
        importer.warn(format!("{}: has no scene: all nodes are shown", file.name));
        let mut is_child = vec![false; root.nodes.len()];
        for child in root
            .nodes
            .iter()
            .flat_map(|node| node.children.iter().flatten())
        {
            if let Some(is_child) = is_child.get_mut(child.value()) {
                *is_child = true;
            }
        }
        let tops = (0..root.nodes.len()).filter(|node| !is_child[*node]);
        let mut steps: Vec<Step> = tops
            .map(|node| step((node, format!("nodes[{node}]"))))
            .collect();
        steps.reverse();
        Ok(steps)
    }

    /// The node's own transform.
    fn local(&self, node: &Node, location: &str) -> Result<DAffine3, SceneError> {
        if let Some(matrix) = node.matrix {
            let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
            let last_row = matrix.row(3);
            if (last_row - glam::DVec4::W).abs().max_element() > 1e-5 {
                let message = "the last row is not 0 0 0 1".to_owned();
                let location = format!("{location}.matrix");
                return Err(self.document.file.refused(location, message));
            }
            return Ok(DAffine3::from_mat4(matrix));
        }
        let vector = |v: [f32; 3]| Vec3::from_array(v).as_dvec3();
        let rotation = match &node.rotation {
            None => DQuat::IDENTITY,
            Some(rotation) => {
                let quaternion = DQuat::from_array(rotation.0.map(f64::from));
                let length = quaternion.length();
                if !(length.is_finite() && length > 1e-6) {
                    let location = format!("{location}.rotation");
                    return Err(self.document.file.refused(location, "has no length"));
                }
                quaternion / length
            }
        };
        Ok(DAffine3::from_scale_rotation_translation(
            node.scale.map_or(DVec3::ONE, vector),
            rotation,
            node.translation.map_or(DVec3::ZERO, vector),
        ))
    }

    /// Places what a node carries.
    fn place(
        &mut self,
        importer: &mut Importer,
        node: &Node,
        location: &str,
        world: &DAffine3,
    ) -> Result<(), SceneError> {
        let document = self.document;
        if let Some(mesh) = node.mesh {
            let index = mesh.value();
            document
                .file
                .element(&document.root.meshes, "meshes", index, location)?;
            let meshes = if let Some(meshes) = self.meshes.get(&index) {
                meshes.clone()
            } else {
                let meshes = primitives::meshes(document, importer, &mut self.materials, index)?;
                self.meshes.insert(index, meshes.clone());
                meshes
            };
            for mesh in meshes {
                importer.add_instance(&document.file.path, mesh, *world)?;
            }
        }
        let extensions = node.extensions.as_ref();
        let light = extensions.and_then(|extensions| extensions.khr_lights_punctual.as_ref());
        if let Some(light) = light
            && self.entry.import_lights
        {
            let index = light.light.value();
            let efficacy = self.entry.luminous_efficacy;
            if let Some(light) =
                lights::convert(document, importer, index, location, world, efficacy)?
            {
                importer.add_light(&document.file.path, self.entry_index, light)?;
            }
        }
        if let Some(camera) = node.camera
            && importer.camera.is_none()
        {
            let cameras = &document.root.cameras;
            let index = camera.value();
            let camera = document.file.element(cameras, "cameras", index, location)?;
            importer.camera = perspective(camera, world);
        }
        Ok(())
    }
}

/// A perspective camera that keeps the description's rules; others are left out.
fn perspective(camera: &gltf::json::Camera, world: &DAffine3) -> Option<CameraDescription> {
    let degrees = f64::from(camera.perspective.as_ref()?.yfov).to_degrees();
    if !(0.1..=170.0).contains(&degrees) {
        return None;
    }
    let position = world.translation;
    let forward = world.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    let up = world.transform_vector3(DVec3::Y).try_normalize()?;
    if forward.cross(up).length() < 1e-3 || position.abs().max_element() > 1e6 {
        return None;
    }
    Some(CameraDescription {
        position: position.to_array(),
        target: (position + forward).to_array(),
        up: up.to_array(),
        vertical_fov_degrees: degrees,
        exposure_ev: 0.0,
        keyframes: Vec::new(),
    })
}
