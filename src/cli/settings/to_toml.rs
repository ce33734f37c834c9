//! Values of settings as TOML.

use std::time::Duration;

use clap::ValueEnum;
use toml::Value;

use super::parse::{
    CameraModel, LightArg, MissingTextureArg, MtlTransparencyArg, RouletteDepth, TextureLod,
};
use crate::accel::AccelSpec;
use crate::film::tonemap::Tonemap;
use crate::film::{PixelFilter, Window};
use crate::formats::EnvironmentSource;
use crate::material::BsdfForm;
use crate::math::Vec3;
use crate::render::Aov;
use crate::sampling::SamplePattern;
use crate::simd::Isa;
use crate::world::LightSamplerKind;

/// A value that TOML can hold, such that it is read again as it was.
pub trait ToToml {
    /// The value; `None` where there is none.
    fn to_toml(&self) -> Option<Value>;
}

impl<T: ToToml> ToToml for Option<T> {
    fn to_toml(&self) -> Option<Value> {
        self.as_ref()?.to_toml()
    }
}

impl<T: ToToml> ToToml for Vec<T> {
    fn to_toml(&self) -> Option<Value> {
        Some(Value::Array(self.iter().filter_map(ToToml::to_toml).collect()))
    }
}

impl ToToml for bool {
    fn to_toml(&self) -> Option<Value> {
        Some((*self).into())
    }
}

impl ToToml for u32 {
    fn to_toml(&self) -> Option<Value> {
        u64::from(*self).to_toml()
    }
}

impl ToToml for usize {
    fn to_toml(&self) -> Option<Value> {
        (*self as u64).to_toml()
    }
}

impl ToToml for u64 {
    /// TOML's numbers end at 2^63 - 1; what is above is a string.
    fn to_toml(&self) -> Option<Value> {
        Some(i64::try_from(*self).map_or_else(|_| self.to_string().into(), Value::from))
    }
}

impl ToToml for f32 {
    /// With as many digits as the `f32` has, not those of the nearest `f64`.
    fn to_toml(&self) -> Option<Value> {
        Some(self.to_string().parse::<f64>().unwrap_or((*self).into()).into())
    }
}

impl ToToml for Vec3 {
    fn to_toml(&self) -> Option<Value> {
        self.to_array().to_vec().to_toml()
    }
}

impl ToToml for (u32, u32) {
    fn to_toml(&self) -> Option<Value> {
        vec![self.0, self.1].to_toml()
    }
}

impl ToToml for Window {
    fn to_toml(&self) -> Option<Value> {
        let corners = [self.x0, self.y0, self.x1, self.y1];
        Some(corners.map(i64::from).to_vec().into())
    }
}

impl ToToml for String {
    fn to_toml(&self) -> Option<Value> {
        Some(self.as_str().into())
    }
}

impl ToToml for Duration {
    /// As it may be typed.
    fn to_toml(&self) -> Option<Value> {
        Some(format!("{}s", self.as_secs_f64()).into())
    }
}

impl ToToml for RouletteDepth {
    fn to_toml(&self) -> Option<Value> {
        self.0.map_or_else(|| Some("off".into()), |depth| depth.to_toml())
    }
}

impl ToToml for EnvironmentSource {
    fn to_toml(&self) -> Option<Value> {
        Some(match self {
            Self::Constant(c) => format!("{},{},{}", c.x, c.y, c.z).into(),
            Self::File(path) => path.display().to_string().into(),
        })
    }
}

/// Types whose names are read as they are displayed.
macro_rules! displayed {
    ($($name:ty),*) => {$(
        impl ToToml for $name {
            fn to_toml(&self) -> Option<Value> {
                Some(self.to_string().into())
            }
        }
    )*};
}
displayed!(AccelSpec, Aov, BsdfForm, Isa, LightSamplerKind, PixelFilter, SamplePattern, Tonemap);

/// Types whose names are those of the help.
macro_rules! listed {
    ($($name:ty),*) => {$(
        impl ToToml for $name {
            fn to_toml(&self) -> Option<Value> {
                Some(self.to_possible_value()?.get_name().into())
            }
        }
    )*};
}
listed!(CameraModel, LightArg, MissingTextureArg, MtlTransparencyArg, TextureLod);
