//! The statements of an MTL file.

use std::path::Path;

use super::lines::{self, Statement};
use super::remarks::Remarks;
use super::texture_statement::{self, Map};
use crate::files::Meter;
use crate::formats::LoadError;
use crate::math::Vec3;

/// A material as the file states it; what is absent is none.
#[derive(Clone, Debug, Default)]
pub(super) struct MtlMaterial {
    pub name: String,
    /// Of its `newmtl`.
    pub line: usize,
    /// Diffuse colour.
    pub kd: Option<Vec3>,
    /// Specular colour.
    pub ks: Option<Vec3>,
    /// Emitted radiance.
    pub ke: Option<Vec3>,
    /// Transmission filter: what of the light goes through.
    pub tf: Option<Vec3>,
    /// Exponent of the specular highlight.
    pub ns: Option<f32>,
    /// Index of refraction.
    pub ni: Option<f32>,
    /// Opacity.
    pub d: Option<f32>,
    /// Transparency, 1 - d.
    pub tr: Option<f32>,
    /// Illumination model, 0 to 10.
    pub illum: Option<u32>,
    /// Roughness.
    pub pr: Option<f32>,
    /// Metalness.
    pub pm: Option<f32>,
    /// Sheen.
    pub ps: Option<f32>,
    /// Strength of a clear coat.
    pub pc: Option<f32>,
    /// Its roughness.
    pub pcr: Option<f32>,
    /// Anisotropy.
    pub aniso: Option<f32>,
    /// Its angle, turns.
    pub anisor: Option<f32>,
    /// Of ambient light, which is not read.
    pub map_ka: Option<Map>,
    pub map_kd: Option<Map>,
    pub map_ks: Option<Map>,
    pub map_ke: Option<Map>,
    pub map_d: Option<Map>,
    pub map_pr: Option<Map>,
    pub map_pm: Option<Map>,
    pub map_ps: Option<Map>,
    pub map_pc: Option<Map>,
    pub map_pcr: Option<Map>,
    /// Heights.
    pub bump: Option<Map>,
    /// Normals.
    pub norm: Option<Map>,
}

impl MtlMaterial {
    /// The maps that may be looked at.
    pub fn used_maps(&self) -> impl Iterator<Item = &Map> {
        let relief = self.norm.as_ref().or(self.bump.as_ref());
        let of_base = [&self.map_kd, &self.map_ks, &self.map_ke, &self.map_d];
        let of_gloss = [&self.map_pr, &self.map_pm, &self.map_ps, &self.map_pc, &self.map_pcr];
        of_base.into_iter().chain(of_gloss).flatten().chain(relief)
    }
}

/// Reads an MTL file.
///
/// # Errors
/// [`LoadError::Line`] at the first malformed statement.
pub(super) fn parse(
    bytes: &[u8],
    file: &Path,
    remarks: &mut Remarks,
) -> Result<Vec<MtlMaterial>, LoadError> {
    let mut materials: Vec<MtlMaterial> = Vec::new();
    lines::for_each(bytes, file, (false, &Meter::default()), |s| {
        if s.keyword == "newmtl" {
            let (name, line) = (lines::name(s.rest), s.line);
            materials.push(MtlMaterial { name, line, ..MtlMaterial::default() });
            return Ok(());
        }
        let Some(material) = materials.last_mut() else {
            remarks.add(s.line, format!("{} before any newmtl is skipped", s.keyword));
            return Ok(());
        };
        statement(material, &s, remarks)
    })?;
    remark_ambient(&materials, remarks);
    Ok(materials)
}

fn statement(
    material: &mut MtlMaterial,
    s: &Statement,
    remarks: &mut Remarks,
) -> Result<(), String> {
    // Writers do not agree on upper and lower case (map_bump, map_Bump).
    match &*s.keyword.to_ascii_lowercase() {
        "kd" => color(&mut material.kd, s, remarks),
        "ks" => color(&mut material.ks, s, remarks),
        "ke" => color(&mut material.ke, s, remarks),
        "tf" | "kt" => color(&mut material.tf, s, remarks),
        "ns" => number(&mut material.ns, s.rest),
        "ni" => number(&mut material.ni, s.rest),
        "d" => read_opacity(material, s, remarks),
        "tr" => number(&mut material.tr, s.rest),
        "pr" => number(&mut material.pr, s.rest),
        "pm" => number(&mut material.pm, s.rest),
        "ps" => number(&mut material.ps, s.rest),
        "pc" => number(&mut material.pc, s.rest),
        "pcr" => number(&mut material.pcr, s.rest),
        "aniso" => number(&mut material.aniso, s.rest),
        "anisor" => number(&mut material.anisor, s.rest),
        "illum" => read_illumination(material, s, remarks),
        "map_kd" => map(&mut material.map_kd, s, remarks),
        "map_ks" => map(&mut material.map_ks, s, remarks),
        "map_ke" => map(&mut material.map_ke, s, remarks),
        "map_d" => map(&mut material.map_d, s, remarks),
        "map_pr" => map(&mut material.map_pr, s, remarks),
        "map_pm" => map(&mut material.map_pm, s, remarks),
        "map_ps" => map(&mut material.map_ps, s, remarks),
        "map_pc" => map(&mut material.map_pc, s, remarks),
        "map_pcr" => map(&mut material.map_pcr, s, remarks),
        "map_bump" | "bump" => map(&mut material.bump, s, remarks),
        "norm" | "map_norm" => map(&mut material.norm, s, remarks),
        "map_ka" => map(&mut material.map_ka, s, remarks),
        // Ambient light is what path tracing computes; anti-aliasing of textures what it does.
        "ka" | "map_aat" => Ok(()),
        _ => {
            // Zero asks for nothing.
            let nothing = lines::numbers(s.rest, 1).is_ok_and(|(numbers, _)| numbers == [0.0; 8]);
            if !nothing {
                remarks.add(s.line, format!("{} is not honoured", s.keyword));
            }
            Ok(())
        }
    }
}

/// `d`: opacity, perhaps with `-halo`, by which it would depend on the viewer.
fn read_opacity(
    material: &mut MtlMaterial,
    s: &Statement,
    remarks: &mut Remarks,
) -> Result<(), String> {
    let halo = s.rest.strip_prefix(b"-halo");
    if halo.is_some() {
        remarks.add(s.line, "d -halo is not honoured: opacity is the same from all sides");
    }
    number(&mut material.d, halo.unwrap_or(s.rest))
}

/// `illum`: the number of an illumination model.
fn read_illumination(
    material: &mut MtlMaterial,
    s: &Statement,
    remarks: &mut Remarks,
) -> Result<(), String> {
    let (numbers, _) = lines::numbers(s.rest, 1)?;
    if (0.0..=10.0).contains(&numbers[0]) {
        material.illum = Some(numbers[0] as u32);
    } else {
        remarks.add(s.line, format!("there is no illum {}", numbers[0]));
    }
    Ok(())
}

fn number(slot: &mut Option<f32>, rest: &[u8]) -> Result<(), String> {
    *slot = Some(lines::numbers(rest, 1)?.0[0]);
    Ok(())
}

fn color(slot: &mut Option<Vec3>, s: &Statement, remarks: &mut Remarks) -> Result<(), String> {
    if s.rest.starts_with(b"spectral") || s.rest.starts_with(b"xyz") {
        remarks.add(s.line, format!("{} other than by RGB is not honoured", s.keyword));
        return Ok(());
    }
    *slot = Some(lines::color(s.rest)?);
    Ok(())
}

/// A map; one that names no file is as if it were not there.
fn map(slot: &mut Option<Map>, s: &Statement, remarks: &mut Remarks) -> Result<(), String> {
    match texture_statement::parse(s.rest, s.line, |remark| remarks.add(s.line, remark))? {
        None => remarks.add(s.line, format!("{} names no file and is skipped", s.keyword)),
        named => *slot = named,
    }
    Ok(())
}

/// Ambient light is what path tracing computes. A map of it is of use only to programs that do not;
/// most files name the picture of `map_Kd` once more, which is no loss.
fn remark_ambient(materials: &[MtlMaterial], remarks: &mut Remarks) {
    for material in materials {
        let Some(ambient) = &material.map_ka else { continue };
        let base = material.map_kd.as_ref();
        if base.is_none_or(|base| base.name != ambient.name) {
            let message = format!("map_Ka {:?} is not honoured: it is not read", ambient.name);
            remarks.add(ambient.line, message);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<(Vec<MtlMaterial>, Vec<String>), LoadError> {
        let file = Path::new("a.mtl");
        let mut remarks = Remarks::new(file);
        let materials = parse(text.as_bytes(), file, &mut remarks)?;
        Ok((materials, remarks.finish().into_iter().map(|notice| notice.message).collect()))
    }

    #[test]
    fn materials_are_parted_by_newmtl_and_names_hold_spaces() {
        let (materials, remarks) = parsed(
            "newmtl  many, many spaces \nKd 1 0.5 0\nKs 0\n\n newmtl\n\tmap_KD a b.png\nillum 2\n",
        )
        .unwrap();
        assert_eq!(materials[0].name, "many, many spaces");
        assert_eq!(materials[0].kd, Some(Vec3::new(1.0, 0.5, 0.0)));
        assert_eq!(materials[0].ks, Some(Vec3::ZERO));
        assert_eq!((&*materials[1].name, materials[1].line), ("", 5));
        assert_eq!(materials[1].map_kd.as_ref().unwrap().name, "a b.png");
        assert!(remarks.is_empty(), "{remarks:?}");
    }

    #[test]
    fn what_is_not_honoured_is_said() {
        let (_, remarks) = parsed(
            "Kd 1 1 1\nnewmtl a\nKa 1 1 1\nPx 0\nPz 0.5\nrefl -type sphere a.png\n\
             Kd spectral a.rfl\nillum 99\nd -halo 0.5\n",
        )
        .unwrap();
        assert_eq!(
            remarks,
            [
                "Kd before any newmtl is skipped",
                "Pz is not honoured",
                "refl is not honoured",
                "Kd other than by RGB is not honoured",
                "there is no illum 99",
                "d -halo is not honoured: opacity is the same from all sides",
            ]
        );
    }

    #[test]
    fn malformed_statements_are_errors_with_their_line() {
        let message = |text: &str| parsed(text).expect_err("the file is broken").to_string();
        assert_eq!(message("newmtl a\nKd 1 2\n"), "a.mtl:2: expected 1 or 3 numbers, found 2");
        assert_eq!(message("newmtl a\nKd -1\n"), "a.mtl:2: a colour is negative");
        assert_eq!(message("newmtl a\nNs\n"), "a.mtl:2: expected 1 numbers, found 0");
        assert_eq!(message("newmtl a\nNs nan\n"), "a.mtl:2: 'nan' is not finite");
        assert_eq!(message("newmtl a\nbump -bm x a.png\n"), "a.mtl:2: 'x' is not a number");
    }

    #[test]
    fn a_map_without_a_name_is_absent_and_said() {
        let maps = [
            "map_Kd", "map_Ks", "map_Ke", "map_d", "map_Bump", "bump", "norm", "map_Pr", "map_Pm",
            "map_Ps", "map_Pc", "map_Pcr", "map_Ka",
        ];
        for keyword in maps {
            let rests = [
                "",
                "  ",
                " -clamp on",
                " -clamp",
                " -bm",
                " -bm 1",
                " -s 1 1 1",
                " -o 0 0 0",
                " -s 1 1 -o 0 0",
                " \"\"",
                " \"",
            ];
            for rest in rests {
                let (materials, remarks) =
                    parsed(&format!("newmtl a\n{keyword}{rest}\nKd 1\n")).expect("it is no error");
                assert_eq!(remarks, [format!("{keyword} names no file and is skipped")]);
                let material = &materials[0];
                assert_eq!(material.kd, Some(Vec3::ONE), "what follows is read");
                let found = [&material.map_kd, &material.map_ka, &material.map_d, &material.bump];
                assert!(found.iter().all(|map| map.is_none()) && material.norm.is_none());
            }
        }
        let (materials, _) = parsed("newmtl a\nmap_Kd a.png\nmap_Kd\n").expect("it is no error");
        assert_eq!(materials[0].map_kd.as_ref().expect("the named one").name, "a.png");
    }

    #[test]
    fn a_map_of_ambient_light_is_said_unless_it_is_that_of_the_base_colour() {
        let (_, remarks) =
            parsed("newmtl a\nmap_Ka gone.png\nnewmtl b\nmap_Ka b.png\nmap_Kd b.png\n")
                .expect("it is well-formed");
        assert_eq!(remarks, ["map_Ka \"gone.png\" is not honoured: it is not read"]);
    }
}
