//! JSON with its place kept, so that every complaint can point at what it is about.

use serde_json::{Map, Value};

/// What is wrong, and where in the document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// A JSON pointer (RFC 6901), or empty for the file as a whole.
    pub place: String,
    /// What is wrong and what to do.
    pub message: String,
}

impl Fault {
    /// A fault at a JSON pointer.
    pub fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: place.into(), message: message.into() }
    }
}

/// The most values that a document may hold: each takes some 32 bytes or more in memory.
const MAX_VALUES: usize = 1 << 25;

/// Parses a document.
pub fn parse(bytes: &[u8]) -> Result<Value, Fault> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        let message = "begins with a byte order mark; save it as UTF-8 without one";
        return Err(Fault::new("", message));
    }
    let values = bytes.iter().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count();
    if values > MAX_VALUES {
        return Err(Fault::new("", format!("the document holds more than {MAX_VALUES} values")));
    }
    serde_json::from_slice(bytes).map_err(|error| Fault::new("", format!("broken JSON: {error}")))
}

/// The pointer to the member `key` of what `place` points to.
pub fn pointer(place: &str, key: &str) -> String {
    format!("{place}/{}", key.replace('~', "~0").replace('/', "~1"))
}

/// A JSON object and the pointer to it.
#[derive(Clone, Debug)]
pub struct Object<'a> {
    members: &'a Map<String, Value>,
    place: String,
}

impl<'a> Object<'a> {
    /// A value that must be an object.
    pub fn new(value: &'a Value, place: String) -> Result<Self, Fault> {
        match value {
            Value::Object(members) => Ok(Self { members, place }),
            other => Err(mismatch(place, "an object", other)),
        }
    }

    /// The pointer to it.
    pub fn place(&self) -> &str {
        &self.place
    }

    /// The pointer to one of its members.
    pub fn at(&self, key: &str) -> String {
        pointer(&self.place, key)
    }

    /// Something wrong with the whole of it.
    pub fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::new(self.place.clone(), message)
    }

    /// Something wrong with one of its members.
    pub fn fault_at(&self, key: &str, message: impl Into<String>) -> Fault {
        Fault::new(self.at(key), message)
    }

    /// Whether the member exists.
    pub fn has(&self, key: &str) -> bool {
        self.members.contains_key(key)
    }

    /// The fault of a member that must be there and is not.
    pub fn absent(&self, key: &str) -> Fault {
        self.fault(format!("{key:?} is missing"))
    }

    /// A member as it is.
    pub fn value(&self, key: &str) -> Option<&'a Value> {
        self.members.get(key)
    }

    /// All members.
    pub fn members(&self) -> impl Iterator<Item = (&'a String, &'a Value)> {
        self.members.iter()
    }

    /// A member that is an object.
    pub fn object(&self, key: &str) -> Result<Option<Object<'a>>, Fault> {
        self.value(key).map(|value| Object::new(value, self.at(key))).transpose()
    }

    /// An extension of this object, by its name.
    pub fn extension(&self, name: &str) -> Result<Option<Object<'a>>, Fault> {
        match self.object("extensions")? {
            Some(extensions) => extensions.object(name),
            None => Ok(None),
        }
    }

    /// A member that is an array; absent: empty.
    pub fn array(&self, key: &str) -> Result<&'a [Value], Fault> {
        match self.value(key) {
            None => Ok(&[]),
            Some(Value::Array(elements)) => Ok(elements),
            Some(other) => Err(mismatch(self.at(key), "an array", other)),
        }
    }

    /// A member that is an array of objects; absent: empty.
    pub fn objects(&self, key: &str) -> Result<Vec<Object<'a>>, Fault> {
        let place = self.at(key);
        let elements = self.array(key)?.iter().enumerate();
        elements.map(|(i, value)| Object::new(value, format!("{place}/{i}"))).collect()
    }

    /// A member that is text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, Fault> {
        match self.value(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => Err(mismatch(self.at(key), "a string", other)),
        }
    }

    /// Its name, which glTF lets nearly everything have; empty if it has none.
    pub fn name(&self) -> Result<String, Fault> {
        Ok(self.text("name")?.unwrap_or_default().to_owned())
    }

    /// A member that is true or false; absent: false.
    pub fn flag(&self, key: &str) -> Result<bool, Fault> {
        match self.value(key) {
            None => Ok(false),
            Some(Value::Bool(flag)) => Ok(*flag),
            Some(other) => Err(mismatch(self.at(key), "true or false", other)),
        }
    }

    /// A member that is a whole number of at least zero; `2.0` is one.
    pub fn whole(&self, key: &str) -> Result<Option<u64>, Fault> {
        self.value(key).map(|value| whole(value, || self.at(key))).transpose()
    }

    /// A whole number that must be there.
    pub fn required_whole(&self, key: &str) -> Result<u64, Fault> {
        self.whole(key)?.ok_or_else(|| self.absent(key))
    }

    /// A member that is an index into an array of `count` things called `what`.
    pub fn reference(&self, key: &str, what: &str, count: usize) -> Result<Option<usize>, Fault> {
        let checked = |value| checked_index(value, what, count, || self.at(key));
        self.value(key).map(checked).transpose()
    }

    /// A reference that must be there.
    pub fn required_reference(&self, key: &str, what: &str, count: usize) -> Result<usize, Fault> {
        self.reference(key, what, count)?.ok_or_else(|| self.absent(key))
    }

    /// A member that is an array of indices; absent: empty.
    pub fn references(&self, key: &str, what: &str, count: usize) -> Result<Vec<usize>, Fault> {
        self.value(key).map_or(Ok(Vec::new()), |value| indices(value, &self.at(key), what, count))
    }

    /// A member that is a number within the range of f32.
    pub fn number(&self, key: &str) -> Result<Option<f32>, Fault> {
        self.value(key).map(|value| number(value, || self.at(key)).map(|x| x as f32)).transpose()
    }

    /// A number that must be there.
    pub fn required_number(&self, key: &str) -> Result<f32, Fault> {
        self.number(key)?.ok_or_else(|| self.absent(key))
    }

    /// A member that is an array of exactly `N` numbers within the range of f32.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Fault> {
        if !self.has(key) {
            return Ok(None);
        }
        let elements = self.array(key)?;
        if elements.len() != N {
            let found = elements.len();
            return Err(self.fault_at(key, format!("has {found} elements and must have {N}")));
        }
        let mut numbers = [0.0; N];
        for (i, (slot, value)) in numbers.iter_mut().zip(elements).enumerate() {
            *slot = number(value, || format!("{}/{i}", self.at(key)))?;
        }
        Ok(Some(numbers))
    }
}

/// The indices of an array at `place`, into an array of `count` things called `what`.
pub fn indices(value: &Value, place: &str, what: &str, count: usize) -> Result<Vec<usize>, Fault> {
    let Value::Array(elements) = value else {
        return Err(mismatch(place.to_owned(), "an array", value));
    };
    let place = |i| format!("{place}/{i}");
    let checked = |(i, value)| checked_index(value, what, count, || place(i));
    elements.iter().enumerate().map(checked).collect()
}

fn checked_index(
    value: &Value,
    what: &str,
    count: usize,
    place: impl Fn() -> String,
) -> Result<usize, Fault> {
    let index = whole(value, &place)?;
    match usize::try_from(index) {
        Ok(index) if index < count => Ok(index),
        _ => Err(Fault::new(place(), format!("refers to {what} {index} of {count}"))),
    }
}

fn whole(value: &Value, place: impl Fn() -> String) -> Result<u64, Fault> {
    const EXACT: f64 = 9007199254740992.0; // 2^53
    if let Some(whole) = value.as_u64() {
        return Ok(whole);
    }
    match value.as_f64() {
        Some(number) if (0.0..=EXACT).contains(&number) && number.fract() == 0.0 => {
            Ok(number as u64)
        }
        Some(number) => Err(Fault::new(place(), format!("{number} is no index, size or count"))),
        None => Err(mismatch(place(), "a whole number", value)),
    }
}

fn number(value: &Value, place: impl Fn() -> String) -> Result<f64, Fault> {
    match value.as_f64() {
        Some(number) if (number as f32).is_finite() => Ok(number),
        Some(number) => {
            Err(Fault::new(place(), format!("{number} is beyond the range of 32-bit floats")))
        }
        None => Err(mismatch(place(), "a number", value)),
    }
}

/// The fault of a value of another type than is wanted there.
pub fn mismatch(place: String, wanted: &str, found: &Value) -> Fault {
    let found = match found {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    };
    Fault::new(place, format!("is {found} and must be {wanted}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with<T>(text: &str, test: impl FnOnce(Object) -> T) -> T {
        let value = parse(text.as_bytes()).expect("valid JSON");
        test(Object::new(&value, String::new()).expect("an object"))
    }

    #[test]
    fn faults_point_at_what_they_mean() {
        with(r#"{"a": [{"b/c": 5}, 7]}"#, |root| {
            let fault = root.objects("a").expect_err("7 is no object");
            assert_eq!(fault, Fault::new("/a/1", "is a number and must be an object"));
        });
        with(r#"{"a": [{"b/c": 5}]}"#, |root| {
            let fault = root.objects("a").expect("objects")[0].reference("b/c", "node", 5);
            assert_eq!(fault, Err(Fault::new("/a/0/b~1c", "refers to node 5 of 5")));
        });
    }

    #[test]
    fn whole_numbers_may_be_written_as_floats() {
        let whole = |text: &str| with(text, |root| root.whole("n"));
        assert_eq!(whole(r#"{"n": 2.0}"#), Ok(Some(2)));
        assert_eq!(whole(r#"{"n": 2e3}"#), Ok(Some(2000)));
        assert_eq!(whole(r"{}"), Ok(None));
        for bad in [r#"{"n": -1}"#, r#"{"n": 0.5}"#, r#"{"n": 1e300}"#, r#"{"n": "1"}"#] {
            assert!(whole(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_fit_f32_and_arrays_have_their_length() {
        with(r#"{"big": 1e39, "three": [1, 2, 3]}"#, |root| {
            assert!(root.number("big").is_err());
            assert_eq!(root.numbers::<3>("three"), Ok(Some([1.0, 2.0, 3.0])));
            assert!(root.numbers::<4>("three").is_err());
        });
    }

    #[test]
    fn byte_order_marks_and_deep_nesting_are_refused() {
        assert!(parse(b"\xef\xbb\xbf{}").is_err());
        assert!(parse("[".repeat(100_000).as_bytes()).is_err());
    }
}
