//! The report for programs.

use serde_json::{Value, json};

use super::report::{Report, kind_of_camera, kind_of_light, name_of_space, traits, unit_of_light};
use crate::camera::Projection;

impl Report<'_> {
    /// The report as a JSON object.
    pub fn to_json(&self) -> String {
        let (scene, survey, memory) = (self.scene, self.survey, self.memory);
        let bounds = (!self.bounds.is_empty()).then(
            || json!({ "min": self.bounds.min.to_array(), "max": self.bounds.max.to_array() }),
        );
        let extensions = scene.contents.extensions.iter();
        let extensions: Vec<_> =
            extensions.map(|e| json!({ "name": e.name, "honoured": e.honoured })).collect();
        let notices = scene.notices.iter();
        let notices: Vec<_> =
            notices.map(|n| json!({ "place": n.place, "message": n.message })).collect();
        let faults = self.faults.iter();
        let faults: Vec<_> =
            faults.map(|(kind, message)| json!({ "kind": kind, "message": message })).collect();
        let environment = scene.environment.as_ref().map(|environment| {
            json!({
                "even": environment.is_constant(),
                "mean": environment.mean().to_array(),
                "sun_towards": environment.sun().map(|sun| sun.direction().to_array()),
            })
        });
        let report = json!({
            "file": self.file,
            "triangles": {
                "unique": survey.unique_triangles,
                "placed": survey.placed_triangles,
                "emitting": survey.emitting_triangles,
                "zero_area": survey.flat_triangles,
            },
            "meshes": scene.meshes.len(),
            "instances": scene.instances.len(),
            "mirrored_instances": survey.mirrored,
            "meshes_without_normals": survey.faceted.len(),
            "bounds": bounds,
            "memory": {
                "meshes": memory.mesh_bytes,
                "placements": memory.placement_bytes,
                "textures": memory.texture_bytes,
                "structure_of_meshes": memory.structure.triangles,
                "structure_of_placements": memory.structure.placements,
                "structure_estimate": memory.structure.total(),
                "total": memory.total(),
            },
            "scenes": scene.contents.scenes,
            "environment": environment,
            "cameras": self.cameras(),
            "lights": self.lights(),
            "materials": self.materials(),
            "textures": self.textures(),
            "variants": scene.contents.variants,
            "extensions": extensions,
            "notices": notices,
            "faults": faults,
        });
        format!("{report:#}\n")
    }

    fn cameras(&self) -> Vec<Value> {
        let camera = |named: &crate::scene::NamedCamera| {
            let projection = &named.camera.projection;
            let (degrees, height) = match *projection {
                Projection::Perspective { yfov } => (Some(yfov.to_degrees()), None),
                Projection::Orthographic { ymag, .. } => (None, Some(2.0 * ymag)),
                Projection::Panorama => (None, None),
            };
            json!({
                "name": named.name,
                "projection": kind_of_camera(projection),
                "yfov_degrees": degrees,
                "height_m": height,
                "aspect": named.aspect,
            })
        };
        self.scene.cameras.iter().map(camera).collect()
    }

    fn lights(&self) -> Vec<Value> {
        let light = |light: &crate::light::Punctual| {
            json!({
                "kind": kind_of_light(light),
                "intensity": light.intensity.to_array(),
                "unit": unit_of_light(light),
                "range_m": light.range,
            })
        };
        self.scene.lights.iter().map(light).collect()
    }

    fn materials(&self) -> Vec<Value> {
        let material = |material: &crate::scene::Material| {
            json!({
                "name": material.name,
                "base_color": material.base_color.to_array(),
                "metallic": material.metallic,
                "roughness": material.roughness,
                "traits": traits(material),
            })
        };
        self.scene.materials.iter().map(material).collect()
    }

    fn textures(&self) -> Vec<Value> {
        let texture = |texture: &crate::texture::Texture| {
            let [width, height] = texture.size();
            json!({
                "name": texture.name(),
                "width": width,
                "height": height,
                "channels": texture.image().channels(),
                "bits": texture.image().depth().bits(),
                "color_space": name_of_space(texture.color_space()),
                "bytes": texture.image().texel_bytes(),
            })
        };
        self.scene.textures.iter().map(texture).collect()
    }
}
