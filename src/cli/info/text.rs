//! The report as text to read.

use std::fmt::Write;

use super::report::{Report, kind_of_camera, kind_of_light, name_of_space, traits, unit_of_light};
use crate::camera::Projection;
use crate::cli::text::{format_bytes, format_figure};

/// The most lines of a list.
const MOST_LINES: usize = 40;

impl Report<'_> {
    /// The report as text.
    pub fn to_text(&self) -> String {
        let (scene, survey) = (self.scene, self.survey);
        let mut text = format!("{}\n", self.file);
        let mut line = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {name:10} {value}");
        };
        line(
            "triangles",
            format!(
                "{} unique, {} placed (meshes: {}, instances: {})",
                survey.unique_triangles,
                survey.placed_triangles,
                scene.meshes.len(),
                scene.instances.len()
            ),
        );
        if !self.bounds.is_empty() {
            let [x, y, z] = self.bounds.extent().to_array().map(|side| format_figure(side.into()));
            line("size", format!("{x} x {y} x {z} m"));
        }
        line(
            "memory",
            format!("about {}: {}", format_bytes(self.memory.total()), self.memory_by_part()),
        );
        if survey.emitting_triangles > 0 {
            line("emitters", format!("{} triangles", survey.emitting_triangles));
        }
        if let Some(environment) = &scene.environment {
            let [r, g, b] = environment.mean().to_array().map(|x| format_figure(x.into()));
            let kind = if environment.is_constant() { "even" } else { "an image" };
            let sun = if environment.sun().is_some() { ", with a sun" } else { "" };
            line("around", format!("{kind}{sun}, {r} {g} {b} in the mean"));
        }
        push_list(&mut text, "scenes", &number_names(&scene.contents.scenes));
        self.list_cameras_and_lights(&mut text);
        self.list_materials_and_textures(&mut text);
        push_list(&mut text, "variants", &number_names(&scene.contents.variants));
        let extensions = scene.contents.extensions.iter().map(|extension| {
            let honoured = if extension.honoured { "" } else { ": not honoured" };
            format!("{}{honoured}", extension.name)
        });
        push_list(&mut text, "extensions", &extensions.collect::<Vec<_>>());
        let notices = scene.notices.iter();
        let notices = notices.map(|notice| format!("{}: {}", notice.place, notice.message));
        push_list(&mut text, "not honoured, or odd", &notices.collect::<Vec<_>>());
        let faults: Vec<_> = self.faults.iter().map(|(_, message)| message.clone()).collect();
        push_list(&mut text, "to look at", &faults);
        text
    }

    fn memory_by_part(&self) -> String {
        let parts = self.memory.parts();
        let parts = parts.map(|(name, bytes)| format!("{name} {}", format_bytes(bytes)));
        parts.join(", ")
    }

    fn list_cameras_and_lights(&self, text: &mut String) {
        let cameras = self.scene.cameras.iter().enumerate().map(|(number, named)| {
            let size = match named.camera.projection {
                Projection::Perspective { yfov } => {
                    format!("{} degrees high", format_figure(yfov.to_degrees().into()))
                }
                Projection::Orthographic { ymag, .. } => {
                    format!("{} m high", format_figure((2.0 * ymag).into()))
                }
                Projection::Panorama => "all around".to_owned(),
            };
            let kind = kind_of_camera(&named.camera.projection);
            format!("{}: {kind}, {size}", format_label(number, &named.name))
        });
        push_list(text, "cameras", &cameras.collect::<Vec<_>>());
        let lights = self.scene.lights.iter().enumerate().map(|(number, light)| {
            let [r, g, b] = light.intensity.to_array().map(|x| format_figure(x.into()));
            let (kind, unit) = (kind_of_light(light), unit_of_light(light));
            format!("{number}: {kind}, {r} {g} {b} {unit}")
        });
        push_list(text, "lights", &lights.collect::<Vec<_>>());
    }

    fn list_materials_and_textures(&self, text: &mut String) {
        let materials = self.scene.materials.iter().enumerate().map(|(number, material)| {
            let traits = traits(material).join(", ");
            let colon = if traits.is_empty() { "" } else { ": " };
            format!("{}{colon}{traits}", format_label(number, &material.name))
        });
        push_list(text, "materials", &materials.collect::<Vec<_>>());
        let textures = self.scene.textures.iter().enumerate().map(|(number, texture)| {
            let ([width, height], image) = (texture.size(), texture.image());
            let space = name_of_space(texture.color_space());
            let (channels, bits) = (image.channels(), image.depth().bits());
            format!(
                "{}: {width}x{height}, {channels} x {bits} bit, {space}",
                format_label(number, texture.name())
            )
        });
        push_list(text, "textures", &textures.collect::<Vec<_>>());
    }
}

/// A number with a name, if there is one.
fn format_label(number: usize, name: &str) -> String {
    if name.is_empty() { number.to_string() } else { format!("{number} {name:?}") }
}

fn number_names(names: &[String]) -> Vec<String> {
    names.iter().enumerate().map(|(number, name)| format_label(number, name)).collect()
}

/// A heading and lines below it; nothing where there are none.
fn push_list(text: &mut String, heading: &str, lines: &[String]) {
    if lines.is_empty() {
        return;
    }
    let _ = writeln!(text, "{heading}");
    for line in &lines[..lines.len().min(MOST_LINES)] {
        let _ = writeln!(text, "  {line}");
    }
    if lines.len() > MOST_LINES {
        let _ = writeln!(text, "  … and {} more (--json)", lines.len() - MOST_LINES);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_cut() {
        let mut text = String::new();
        push_list(&mut text, "none", &[]);
        assert_eq!(text, "");
        push_list(&mut text, "many", &vec!["a".to_owned(); 50]);
        assert_eq!(text.lines().count(), 42);
        assert!(text.ends_with("… and 10 more (--json)\n"));
    }
}
