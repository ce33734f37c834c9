//! What fills all space of a TOML scene.

use super::reader::Table;
use crate::formats::LoadError;
use crate::math::{DVec3, Vec3};
use crate::medium::Medium;

/// `[medium]`: what it absorbs and scatters of light per metre, by colour or of all, and whereto.
pub fn medium(table: &Table) -> Result<Medium, LoadError> {
    let absorption = per_metre(table, "absorption")?;
    let scattering = per_metre(table, "scattering")?;
    let anisotropy = table.number_in("anisotropy", -1.0..=1.0)?.unwrap_or(0.0);
    table.finish()?;
    let extinction = absorption + scattering;
    if extinction == DVec3::ZERO {
        return Err(table.fault("neither absorbs nor scatters: give it absorption or scattering"));
    }
    let share = |scattered: f64, all: f64| if all > 0.0 { (scattered / all) as f32 } else { 0.0 };
    let albedo = Vec3::new(
        share(scattering.x, extinction.x),
        share(scattering.y, extinction.y),
        share(scattering.z, extinction.z),
    );
    Ok(Medium::new(extinction.as_vec3(), albedo, anisotropy))
}

fn per_metre<'d>(table: &Table<'d>, key: &'d str) -> Result<DVec3, LoadError> {
    let value = DVec3::from_array(table.scale(key)?.unwrap_or([0.0; 3]));
    // As it is rounded and told: the most itself is no fault.
    let most = 0.5 * Medium::MOST_EXTINCTION;
    if value.min_element() < 0.0 || value.max_element() as f32 > most {
        return Err(table.fault_at(key, format!("must be from 0 to {most:e} per metre")));
    }
    Ok(value)
}
