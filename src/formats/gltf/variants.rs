//! Variants of materials: one choice for the whole file, made by name (KHR_materials_variants).

use super::json::{Fault, Object};

const NAME: &str = "KHR_materials_variants";

/// The names of the variants that the document declares, in its order.
pub fn names(root: &Object) -> Result<Vec<String>, Fault> {
    let Some(extension) = root.extension(NAME)? else { return Ok(Vec::new()) };
    extension.objects("variants")?.iter().map(Object::name).collect()
}

/// How many variants and materials a document has, and which variant is shown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Variants {
    /// Variants.
    pub count: usize,
    /// Materials.
    pub materials: usize,
    /// The variant asked for.
    pub shown: Option<usize>,
}

impl Variants {
    /// The material of a primitive: that of the variant that is shown, if it has one of its own.
    pub fn material(self, primitive: &Object) -> Result<Option<usize>, Fault> {
        let mut material = primitive.reference("material", "material", self.materials)?;
        let Some(extension) = primitive.extension(NAME)? else { return Ok(material) };
        let mut found = false;
        for mapping in extension.objects("mappings")? {
            let mapped = mapping.required_reference("material", "material", self.materials)?;
            let variants = mapping.references("variants", "variant", self.count)?;
            if !found && variants.iter().any(|&variant| Some(variant) == self.shown) {
                (material, found) = (Some(mapped), true);
            }
        }
        Ok(material)
    }
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn material(text: &str, shown: Option<usize>) -> Result<Option<usize>, Fault> {
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let primitive = Object::new(&value, "/p".to_owned()).expect("an object");
        Variants { count: 3, materials: 4, shown }.material(&primitive)
    }

    #[test]
    fn a_variant_without_a_material_shows_the_primitives_own() {
        let text = r#"{"material": 3, "extensions": {"KHR_materials_variants": {"mappings":
            [{"material": 1, "variants": [0]}, {"material": 2, "variants": [2, 0]}]}}}"#;
        for (shown, expected) in [(None, 3), (Some(0), 1), (Some(1), 3), (Some(2), 2)] {
            assert_eq!(material(text, shown), Ok(Some(expected)), "{shown:?}");
        }
        assert_eq!(material("{}", Some(0)), Ok(None));
    }

    #[test]
    fn references_are_checked_whatever_is_shown() {
        for mapping in [r#"{"material": 4, "variants": []}"#, r#"{"material": 0, "variants": [3]}"#]
        {
            let text = format!(
                "{{\"extensions\": {{\"KHR_materials_variants\": {{\"mappings\": [{mapping}]}}}}}}"
            );
            assert!(material(&text, None).is_err(), "{mapping}");
        }
    }
}
