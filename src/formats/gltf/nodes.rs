//! The node graph: which nodes are drawn, and where they stand (glTF 2.0, 3.5.2 and 3.5.3).
//!
//! Every walk is a loop, so that a file of a million nested nodes is only a long one, and matrices
//! are multiplied in f64, so that thirty nested joints still meet where they should.

use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::instancing::Instancing;
use super::json::{Fault, Object};
use super::mesh;
use super::notices::Notices;

/// How many of everything there are that a node may refer to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Nodes.
    pub nodes: usize,
    /// Meshes.
    pub meshes: usize,
    /// Accessors.
    pub accessors: usize,
    /// Cameras.
    pub cameras: usize,
    /// Lights of KHR_lights_punctual.
    pub lights: usize,
    /// Skins.
    pub skins: usize,
}

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    /// What the file calls it.
    pub name: String,
    /// Nodes whose transforms are relative to it.
    pub children: Vec<usize>,
    /// What it draws.
    pub mesh: Option<usize>,
    /// What that follows instead of this node.
    pub skin: Option<usize>,
    /// Weights of its morph targets; none: those of the mesh.
    pub weights: Option<Vec<f32>>,
    /// Where copies of that stand; none: it stands at the node alone.
    pub copies: Option<Instancing>,
    /// A camera that it carries.
    pub camera: Option<usize>,
    /// A light that it carries.
    pub light: Option<usize>,
    /// Whether it and what is below it are seen (KHR_node_visibility).
    pub visible: bool,
    /// To its parent's space.
    pub local: DAffine3,
    /// What that is made of, as far as it can be told of a matrix.
    pub parts: Parts,
}

/// What a node's transform is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Done last.
    pub translation: DVec3,
    /// Of unit length.
    pub rotation: DQuat,
    /// Done first.
    pub scale: DVec3,
}

impl Parts {
    /// To the parent's space.
    pub fn local(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// A node that is drawn, and where.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    pub node: usize,
    /// From its space to the world.
    pub to_world: DAffine3,
    /// Whether it and all above it are seen: its mesh is there, its light shines.
    pub visible: bool,
}

/// Reads all nodes.
pub fn read(root: &Object, counts: Counts, notices: &mut Notices) -> Result<Vec<Node>, Fault> {
    root.objects("nodes")?.iter().map(|object| node(object, counts, notices)).collect()
}

fn node(object: &Object, counts: Counts, notices: &mut Notices) -> Result<Node, Fault> {
    let light = match object.extension("KHR_lights_punctual")? {
        Some(extension) => Some(extension.required_reference("light", "light", counts.lights)?),
        None => None,
    };
    let visible = match object.extension("KHR_node_visibility")? {
        Some(extension) => !extension.has("visible") || extension.flag("visible")?,
        None => true,
    };
    let (local, parts) = local(object, notices)?;
    Ok(Node {
        name: object.name()?,
        children: object.references("children", "node", counts.nodes)?,
        mesh: object.reference("mesh", "mesh", counts.meshes)?,
        skin: object.reference("skin", "skin", counts.skins)?,
        weights: if object.has("weights") { Some(mesh::weights(object)?) } else { None },
        copies: Instancing::read(object, counts.accessors, notices)?,
        camera: object.reference("camera", "camera", counts.cameras)?,
        light,
        visible,
        local,
        parts,
    })
}

/// The matrix, or else translation, rotation and scale.
fn local(object: &Object, notices: &mut Notices) -> Result<(DAffine3, Parts), Fault> {
    let translation = object.numbers::<3>("translation")?.unwrap_or_default();
    let rotation = object.numbers::<4>("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = object.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
    if let Some(columns) = object.numbers::<16>("matrix")? {
        if ["translation", "rotation", "scale"].iter().any(|key| object.has(key)) {
            return Err(object.fault("has both a matrix and translation, rotation or scale"));
        }
        let matrix = DMat4::from_cols_array(&columns);
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            return Err(object.fault_at("matrix", "its last row must be 0 0 0 1"));
        }
        let local = DAffine3::from_mat4(matrix);
        let (scale, rotation, translation) = local.to_scale_rotation_translation();
        return Ok((local, Parts { translation, rotation, scale }));
    }
    let rotation = DQuat::from_array(rotation);
    let length = rotation.length();
    if length < 1e-6 {
        return Err(object.fault_at("rotation", "is no rotation: its length is 0"));
    }
    if (length - 1.0).abs() > 1e-3 {
        notices.add(object.at("rotation"), "is not of unit length, and was normalised");
    }
    let parts = Parts {
        translation: DVec3::from_array(translation),
        rotation: rotation * (1.0 / length),
        scale: DVec3::from_array(scale),
    };
    Ok((parts.local(), parts))
}

/// Of each node its parent; refuses nodes with two parents and nodes below themselves.
pub fn parents(nodes: &[Node]) -> Result<Vec<Option<usize>>, Fault> {
    let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        for (k, &child) in node.children.iter().enumerate() {
            if let Some(other) = parents[child].replace(i) {
                let place = format!("/nodes/{i}/children/{k}");
                let message = format!("node {child} has two parents, {other} and {i}");
                return Err(Fault::new(place, message));
            }
        }
    }
    // With one parent each, whatever the walk down from the roots does not reach is in a cycle.
    let mut reached = vec![false; nodes.len()];
    let mut pending: Vec<usize> = (0..nodes.len()).filter(|&i| parents[i].is_none()).collect();
    while let Some(node) = pending.pop() {
        reached[node] = true;
        pending.extend(&nodes[node].children);
    }
    match reached.iter().position(|reached| !reached) {
        Some(node) => Err(Fault::new(format!("/nodes/{node}"), "is its own ancestor")),
        None => Ok(parents),
    }
}

/// The nodes below `roots`, each before its children, children in their order. `roots` have no
/// parents and are told apart.
pub fn place(nodes: &[Node], roots: &[usize]) -> Vec<Placed> {
    let mut placed = Vec::new();
    let root = |&node: &usize| {
        let Node { local, visible, .. } = nodes[node];
        Placed { node, to_world: local, visible }
    };
    let mut pending: Vec<Placed> = roots.iter().rev().map(root).collect();
    while let Some(at) = pending.pop() {
        placed.push(at);
        pending.extend(nodes[at.node].children.iter().rev().map(|&node| {
            let Node { local, visible, .. } = nodes[node];
            Placed { node, to_world: at.to_world * local, visible: at.visible && visible }
        }));
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn nodes(text: &str) -> Result<Vec<Node>, Fault> {
        let value = json::parse(format!("{{\"nodes\": {text}}}").as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        let counts =
            Counts { nodes: root.array("nodes").expect("nodes").len(), ..Counts::default() };
        read(&root, counts, &mut Notices::default())
    }

    #[test]
    fn transforms_multiply_down_the_tree() {
        let nodes = nodes(
            r#"[{"children": [1], "scale": [2, 2, 2]},
                {"translation": [1, 0, 0], "rotation": [0, 0, 1, 0]}]"#,
        )
        .expect("valid");
        let placed = place(&nodes, &[0]);
        assert_eq!(placed.len(), 2);
        let point = placed[1].to_world.transform_point3(DVec3::new(1.0, 1.0, 0.0));
        assert!(point.distance(DVec3::new(0.0, -2.0, 0.0)) < 1e-12);
    }

    #[test]
    fn matrices_are_stored_by_columns() {
        let nodes = nodes(r#"[{"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1]}]"#).expect("valid");
        assert_eq!(nodes[0].local.translation, DVec3::new(7.0, 8.0, 9.0));
    }

    #[test]
    fn graphs_that_are_no_trees_are_refused() {
        let check = |text: &str| parents(&nodes(text).expect("valid"));
        assert_eq!(check(r#"[{"children": [1]}, {}]"#), Ok(vec![None, Some(0)]));
        for (text, message) in [
            (r#"[{"children": [0]}]"#, "is its own ancestor"),
            (r#"[{}, {"children": [2]}, {"children": [1]}]"#, "is its own ancestor"),
            (r#"[{"children": [2]}, {"children": [2]}, {}]"#, "node 2 has two parents, 0 and 1"),
            (r#"[{"children": [1, 1]}, {}]"#, "node 1 has two parents, 0 and 0"),
        ] {
            assert_eq!(check(text).expect_err(text).message, message);
        }
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_is_only_long() {
        let link = |i| format!("{{\"children\": [{i}], \"translation\": [1, 0, 0]}},");
        let chain: String = (1..100_000).map(link).collect();
        let nodes = nodes(&format!("[{chain}{{}}]")).expect("valid");
        parents(&nodes).expect("a tree");
        let last = place(&nodes, &[0]).last().copied().expect("placed");
        assert_eq!(last.to_world.translation.x, 99_999.0);
    }
}
