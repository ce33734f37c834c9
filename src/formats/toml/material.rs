//! Overrides of materials: factors by their names in glTF.

use std::ops::RangeInclusive;

use super::reader::Table;
use crate::formats::LoadError;
use crate::math::{Vec2, Vec3};
use crate::scene::{AlphaMode, Material, MaterialLayers, ScatterColor, Scattering, Volume};

type Setter<T> = fn(&mut Material, T);

const ANY: RangeInclusive<f32> = 0.0..=f32::MAX;
const SHARE: RangeInclusive<f32> = 0.0..=1.0;

/// Keys of colours, the most that each of three numbers may be, and what they set.
const COLORS: &[(&str, f32, Setter<Vec3>)] = &[
    ("base-color", 1.0, |m, color| m.base_color = color.extend(m.base_color.w)),
    ("emissive", f32::MAX, |m, color| m.emissive = color),
    ("specular-color", f32::MAX, |m, color| m.specular_color = color),
    ("attenuation-color", 1.0, |m, color| volume(m).attenuation_color = color),
    ("sheen-color", 1.0, |m, color| layers(m).sheen_color = color),
    ("diffuse-transmission-color", 1.0, |m, color| m.diffuse_transmission_color = color),
    ("multiscatter-color", 1.0, |m, color| scattering(m).color = ScatterColor::All(color)),
    ("scatter-albedo", 1.0, |m, color| scattering(m).color = ScatterColor::One(color)),
];

/// Keys of numbers, their ranges, and what they set.
const NUMBERS: &[(&str, RangeInclusive<f32>, Setter<f32>)] = &[
    ("metallic", SHARE, |m, value| m.metallic = value),
    ("roughness", SHARE, |m, value| m.roughness = value),
    ("ior", 0.0..=f32::MAX, |m, value| m.ior = value),
    ("specular", SHARE, |m, value| m.specular = value),
    ("transmission", SHARE, |m, value| m.transmission = value),
    ("diffuse-transmission", SHARE, |m, value| m.diffuse_transmission = value),
    ("scatter-anisotropy", -1.0..=1.0, |m, value| scattering(m).anisotropy = value),
    ("emissive-strength", ANY, |m, value| m.emissive *= value),
    ("normal-scale", -f32::MAX..=f32::MAX, |m, value| m.normal_scale = value),
    ("alpha", SHARE, |m, value| {
        m.base_color.w = value;
        if m.alpha_mode == AlphaMode::Opaque && value < 1.0 {
            m.alpha_mode = AlphaMode::Blend;
        }
    }),
    ("alpha-cutoff", ANY, |m, value| m.alpha_mode = AlphaMode::Mask(value)),
    ("attenuation-distance", f32::MIN_POSITIVE..=f32::MAX, |m, value| {
        volume(m).attenuation_distance = value;
    }),
    ("clearcoat", SHARE, |m, value| layers(m).clearcoat = value),
    ("clearcoat-roughness", SHARE, |m, value| layers(m).clearcoat_roughness = value),
    ("sheen-roughness", SHARE, |m, value| layers(m).sheen_roughness = value),
    ("anisotropy", SHARE, |m, value| layers(m).anisotropy = value),
    ("dispersion", ANY, |m, value| m.dispersion = value),
    ("iridescence", SHARE, |m, value| layers(m).iridescence = value),
    ("iridescence-ior", 1.0..=f32::MAX, |m, value| layers(m).iridescence_ior = value),
    ("iridescence-thickness", ANY, |m, value| layers(m).iridescence_thickness = [value; 2]),
    ("iridescence-thickness-minimum", ANY, |m, value| layers(m).iridescence_thickness[0] = value),
    ("clearcoat-normal-scale", -f32::MAX..=f32::MAX, |m, value| {
        layers(m).clearcoat_normal_scale = value;
    }),
    ("priority", -1e6..=1e6, |m, value| m.priority = value as i32),
    ("anisotropy-rotation", -360.0..=360.0, |m, degrees| {
        let (s, c) = libm::sincosf(degrees.to_radians());
        layers(m).anisotropy_rotation = Vec2::new(c, s);
    }),
];

/// Keys of switches, and what they set.
const SWITCHES: &[(&str, Setter<bool>)] = &[
    ("double-sided", |m, on| m.double_sided = on),
    ("unlit", |m, on| m.unlit = on),
    ("solid", |m, on| {
        if !on {
            m.volume = None;
        } else {
            volume(m);
        }
    }),
    ("textures", |m, on| {
        if !on {
            m.texture_slots_mut().for_each(|slot| *slot = None);
        }
    }),
];

fn volume(material: &mut Material) -> &mut Volume {
    let clear = Volume { attenuation_color: Vec3::ONE, attenuation_distance: f32::INFINITY };
    material.volume.get_or_insert(clear)
}

fn scattering(material: &mut Material) -> &mut Scattering {
    material.scattering.get_or_insert(Scattering::NONE)
}

fn layers(material: &mut Material) -> &mut MaterialLayers {
    material.layers.get_or_insert_default()
}

/// Changes of materials, each for those of one name.
#[derive(Clone, Default, PartialEq)]
pub struct Overrides {
    all: Vec<Override>,
}

#[derive(Clone, PartialEq)]
struct Override {
    /// Of the materials; `*`: all.
    name: String,
    line: usize,
    changes: Vec<Change>,
}

/// A row of one of the tables above, and the value.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    Color(usize, Vec3),
    Number(usize, f32),
    Switch(usize, bool),
    /// `alpha-mode`; a mask keeps the cutoff of one that there is.
    Mode(AlphaMode),
}

impl Overrides {
    /// The tables of a table, each called like a material.
    pub fn read(tables: &Table) -> Result<Self, LoadError> {
        let mut all = Vec::new();
        for (name, table) in tables.all_tables()? {
            let (name, line) = (name.to_owned(), table.line());
            all.push(Override { name, line, changes: read_changes(&table)? });
        }
        // What is said of all gives way to what is said of one.
        all.sort_by_key(|one| one.name != "*");
        Ok(Self { all })
    }

    /// These, then those of `later`.
    pub fn merge(&self, later: &Self) -> Self {
        Self { all: self.all.iter().chain(&later.all).cloned().collect() }
    }

    /// Makes all changes that a material's name calls for.
    pub fn apply(&self, material: &mut Material) {
        for one in &self.all {
            if one.name != "*" && one.name != material.name {
                continue;
            }
            for change in &one.changes {
                match *change {
                    Change::Color(row, value) => (COLORS[row].2)(material, value),
                    Change::Number(row, value) => (NUMBERS[row].2)(material, value),
                    Change::Switch(row, value) => (SWITCHES[row].1)(material, value),
                    Change::Mode(AlphaMode::Mask(_))
                        if matches!(material.alpha_mode, AlphaMode::Mask(_)) => {}
                    Change::Mode(mode) => material.alpha_mode = mode,
                }
            }
        }
        if material.layers.as_ref().is_some_and(|layers| !layers.any()) {
            material.layers = None;
        }
        if material.unlit {
            *material = std::mem::take(material).into_unlit();
        }
    }

    /// The first name, with its line, that no material of `names` has.
    pub fn find_unmatched(&self, names: &[String]) -> Option<(&str, usize)> {
        let missing = |one: &&Override| one.name != "*" && !names.contains(&one.name);
        self.all.iter().find(missing).map(|one| (one.name.as_str(), one.line))
    }
}

/// Switches first, since one drops textures and another the solid that colours may bring back.
fn read_changes(table: &Table) -> Result<Vec<Change>, LoadError> {
    let mut changes = Vec::new();
    for (row, (key, _)) in SWITCHES.iter().enumerate() {
        changes.extend(table.switch(key)?.map(|value| Change::Switch(row, value)));
    }
    for (row, (key, most, _)) in COLORS.iter().enumerate() {
        let Some(color) = table.numbers::<3>(key)? else { continue };
        let color = color.map(|value| value as f32);
        if !color.iter().all(|value| (0.0..=*most).contains(value)) {
            let most = if *most == 1.0 { " and at most 1" } else { "" };
            return Err(table.fault_at(key, format!("a colour's numbers are 0 or more{most}")));
        }
        changes.push(Change::Color(row, Vec3::from(color)));
    }
    for (row, (key, range, _)) in NUMBERS.iter().enumerate() {
        let value = table.number_in(key, range.clone())?;
        if let Some(message) = value.and_then(|value| gap(key, value)) {
            return Err(table.fault_at(key, message));
        }
        changes.extend(value.map(|value| Change::Number(row, value)));
    }
    if table.has("scatter-albedo") && table.has("multiscatter-color") {
        let message = "goes without multiscatter-color: give one of the two";
        return Err(table.fault_at("scatter-albedo", message));
    }
    // Last, since an alpha or a cutoff implies a mode of its own.
    changes.extend(alpha_mode(table)?.map(Change::Mode));
    table.finish()?;
    Ok(changes)
}

/// What is wrong with a value inside of its key's range; none for most.
fn gap(key: &str, value: f32) -> Option<&'static str> {
    match key {
        "ior" if value > 0.0 && value < 1.0 => Some("must be at least 1, or 0 for infinity"),
        "priority" if value.fract() != 0.0 => Some("must be a whole number"),
        _ => None,
    }
}

fn alpha_mode(table: &Table) -> Result<Option<AlphaMode>, LoadError> {
    let mode = match table.text("alpha-mode")? {
        None => return Ok(None),
        Some("opaque") => AlphaMode::Opaque,
        // The default of glTF 2.0, 5.19.10.
        Some("mask") => AlphaMode::Mask(0.5),
        Some("blend") => AlphaMode::Blend,
        Some(other) => {
            let message = format!("{other:?} is none of opaque, mask and blend");
            return Err(table.fault_at("alpha-mode", message));
        }
    };
    if table.has("alpha-cutoff") && !matches!(mode, AlphaMode::Mask(_)) {
        return Err(table.fault_at("alpha-cutoff", "needs alpha-mode = \"mask\", or none"));
    }
    Ok(Some(mode))
}
