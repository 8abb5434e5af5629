//! The table of a sweep as Apache Parquet, for programs that read columns (feature `parquet`).

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use serde_json::Value;

use super::table::Table;

/// Columns that are text whatever is in them.
const WORDS: [&str; 5] = ["key", "role", "ending", "log", "reason"];

impl Table {
    /// As a Parquet file of one row group: numbers as doubles, all else as text; what a row does not have is null.
    ///
    /// # Errors
    /// Where the writer cannot write a column.
    pub fn to_parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let names = self.columns();
        let rows: Vec<Vec<Value>> = self.rows.iter().map(|row| self.values(row)).collect();
        let of = |column: usize| rows.iter().map(move |row| &row[column]);
        let is_number: Vec<bool> = (0..names.len())
            .map(|column| {
                !WORDS.contains(&&names[column][..]) && of(column).all(|value| value.is_number() || value.is_null())
            })
            .collect();
        let fields = names.iter().zip(&is_number).map(|(name, is_number)| field(name, *is_number));
        let fields = fields.collect::<Result<Vec<_>, _>>()?;
        let schema = Type::group_type_builder("sweep").with_fields(fields).build()?;
        let mut written = Vec::new();
        let mut writer =
            SerializedFileWriter::new(&mut written, Arc::new(schema), Arc::new(WriterProperties::default()))?;
        let mut group = writer.next_row_group()?;
        for (column, is_number) in is_number.iter().enumerate() {
            let Some(mut open) = group.next_column()? else { break };
            let present: Vec<i16> = of(column).map(|value| i16::from(!value.is_null())).collect();
            if *is_number {
                let numbers: Vec<f64> = of(column).filter_map(Value::as_f64).collect();
                open.typed::<DoubleType>().write_batch(&numbers, Some(&present), None)?;
            } else {
                let words = of(column).filter(|value| !value.is_null());
                let words: Vec<ByteArray> = words.map(|value| ByteArray::from(&text(value)[..])).collect();
                open.typed::<ByteArrayType>().write_batch(&words, Some(&present), None)?;
            }
            open.close()?;
        }
        group.close()?;
        writer.close()?;
        Ok(written)
    }
}

fn field(name: &str, is_number: bool) -> Result<Arc<Type>, ParquetError> {
    let physical = if is_number { Physical::DOUBLE } else { Physical::BYTE_ARRAY };
    let kind = (!is_number).then_some(LogicalType::String);
    let field = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
    Ok(Arc::new(field.with_logical_type(kind).build()?))
}

fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
