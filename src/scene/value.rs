//! Values of TOML as numbers, and their types.

use toml::de::{DeInteger, DeValue};

use super::problem::ValueType;

/// The value as a number, if it is one.
pub(super) fn as_float(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(integer) => Some(integer_value(integer)),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

/// An integer of any length; where it does not fit a number exactly, all limits are far below.
pub(super) fn integer_value(integer: &DeInteger<'_>) -> f64 {
    match i128::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(value) => value as f64,
        Err(_) if integer.as_str().starts_with('-') => f64::MIN,
        Err(_) => f64::MAX,
    }
}

/// The type of a value.
pub(super) fn value_type(value: &DeValue<'_>) -> ValueType {
    match value {
        DeValue::String(_) => ValueType::Text,
        DeValue::Integer(_) => ValueType::Integer,
        DeValue::Float(_) => ValueType::Float,
        DeValue::Boolean(_) => ValueType::Boolean,
        DeValue::Datetime(_) => ValueType::Date,
        DeValue::Array(_) => ValueType::Array,
        DeValue::Table(_) => ValueType::Table,
    }
}
