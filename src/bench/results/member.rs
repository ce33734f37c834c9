//! Members of a JSON file that anyone may have written, with errors that name them.

use serde_json::Value;

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{member} {why}")]
pub struct Malformed {
    /// The way to the member, such as `walks[3].bytes`.
    member: String,
    /// As an end of the sentence.
    why: String,
}

/// A value and the way to it.
#[derive(Clone, Debug)]
pub struct Member<'a> {
    way: String,
    value: &'a Value,
}

impl<'a> Member<'a> {
    /// The whole of a file.
    pub fn root(value: &'a Value) -> Self {
        Self { way: String::new(), value }
    }

    /// An error about this one.
    pub fn wrong(&self, why: impl Into<String>) -> Malformed {
        let member = if self.way.is_empty() { "the whole".to_owned() } else { self.way.clone() };
        Malformed { member, why: why.into() }
    }

    fn child(&self, key: &str, value: &'a Value) -> Self {
        let dot = if self.way.is_empty() { "" } else { "." };
        Self { way: format!("{}{dot}{key}", self.way), value }
    }

    /// A member of this object.
    ///
    /// # Errors
    /// If this is no object, or has none of that name.
    pub fn get(&self, key: &str) -> Result<Self, Malformed> {
        if !self.value.is_object() {
            return Err(self.wrong("is not an object"));
        }
        let found = self.value.get(key).map(|value| self.child(key, value));
        found.ok_or_else(|| self.child(key, &Value::Null).wrong("is missing"))
    }

    /// A member that may be absent or null.
    pub fn optional(&self, key: &str) -> Option<Self> {
        let value = self.value.get(key).filter(|value| !value.is_null());
        value.map(|value| self.child(key, value))
    }

    /// The items of this list.
    ///
    /// # Errors
    /// If it is none.
    pub fn items(&self) -> Result<Vec<Self>, Malformed> {
        let items = self.value.as_array().ok_or_else(|| self.wrong("is not a list"))?;
        let item = |(i, value)| Self { way: format!("{}[{i}]", self.way), value };
        Ok(items.iter().enumerate().map(item).collect())
    }

    /// The members of this object.
    ///
    /// # Errors
    /// If it is none.
    pub fn entries(&self) -> Result<Vec<(&'a str, Self)>, Malformed> {
        let entries = self.value.as_object().ok_or_else(|| self.wrong("is not an object"))?;
        Ok(entries.iter().map(|(key, value)| (key.as_str(), self.child(key, value))).collect())
    }

    /// A text.
    ///
    /// # Errors
    /// If it is none.
    pub fn text(&self) -> Result<&'a str, Malformed> {
        self.value.as_str().ok_or_else(|| self.wrong("is not a text"))
    }

    /// A number.
    ///
    /// # Errors
    /// If it is none.
    pub fn number(&self) -> Result<f64, Malformed> {
        let number = self.value.as_f64().filter(|number| number.is_finite());
        number.ok_or_else(|| self.wrong("is not a number"))
    }

    /// A number above zero, as rates and seconds are.
    ///
    /// # Errors
    /// If it is none.
    pub fn positive(&self) -> Result<f64, Malformed> {
        let number = self.number()?;
        if number > 0.0 { Ok(number) } else { Err(self.wrong("is not above zero")) }
    }

    /// A truth value.
    ///
    /// # Errors
    /// If it is none.
    pub fn is_true(&self) -> Result<bool, Malformed> {
        self.value.as_bool().ok_or_else(|| self.wrong("is neither true nor false"))
    }

    /// A whole number.
    ///
    /// # Errors
    /// If it is none of 0 or more.
    pub fn count(&self) -> Result<u64, Malformed> {
        self.value.as_u64().ok_or_else(|| self.wrong("is not a whole number of 0 or more"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn errors_name_the_way_to_the_member() {
        let file = json!({ "a": [{ "b": -1.5 }, { "b": "x" }], "n": null });
        let root = Member::root(&file);
        let items = root.get("a").and_then(|a| a.items()).expect("a list");
        let b = |i: usize| items[i].get("b").expect("is there");
        let told = |error: Malformed| error.to_string();
        assert_eq!(b(0).positive().map_err(told), Err("a[0].b is not above zero".to_owned()));
        assert_eq!(b(1).number().map_err(told), Err("a[1].b is not a number".to_owned()));
        assert_eq!(b(0).count().map_err(told).err().as_deref(), {
            Some("a[0].b is not a whole number of 0 or more")
        });
        assert_eq!(b(0).get("c").map_err(told).err().as_deref(), Some("a[0].b is not an object"));
        assert_eq!(root.get("z").map_err(told).err().as_deref(), Some("z is missing"));
        assert!(root.optional("n").is_none() && root.optional("a").is_some());
        assert_eq!(told(root.wrong("is not an object")), "the whole is not an object");
    }
}
