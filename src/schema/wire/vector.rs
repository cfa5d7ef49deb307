//! Rows of numbers of a fixed length, and their OpenAPI schema.

use serde::{Deserialize, Serialize};
use utoipa::openapi::schema::{ArrayBuilder, KnownFormat, ObjectBuilder, SchemaFormat, SchemaType};
use utoipa::openapi::{RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use mechanics::mesh::Vector;

/// x, y, z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Triple(pub [f64; 3]);

/// x, y, z, each of which may be null.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PartialTriple(pub [Option<f64>; 3]);

/// A 4x4 matrix, row by row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Matrix4x4(pub [f64; 16]);

/// Lowest and highest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Interval(pub [f64; 2]);

/// Lowest and highest value for each of x, y and z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Intervals(pub [[f64; 2]; 3]);

/// Centre and radius of a sphere: x, y, z, r.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Sphere(pub [f64; 4]);

/// Lowest and highest corner of a box: x0, y0, z0, x1, y1, z1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CornerPair(pub [f64; 6]);

/// Three points by their numbers, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TriangleCorners(pub [u32; 3]);

impl PartialSchema for TriangleCorners {
    fn schema() -> RefOr<Schema> {
        let array = ArrayBuilder::new()
            .items(u32::schema())
            .min_items(Some(3))
            .max_items(Some(3))
            .description(Some("three points by their numbers, counted from 0"));
        array.into()
    }
}

impl ToSchema for TriangleCorners {}

impl From<Triple> for Vector {
    fn from(Triple(xyz): Triple) -> Vector {
        Vector::from(xyz)
    }
}

impl From<Vector> for Triple {
    fn from(vector: Vector) -> Triple {
        Triple(vector.into())
    }
}

/// An array of exactly `length` numbers.
fn numbers(length: usize, nullable: bool, description: &str) -> RefOr<Schema> {
    let mut types = vec![Type::Number];
    if nullable {
        types.push(Type::Null);
    }
    let number = ObjectBuilder::new()
        .schema_type(SchemaType::from_iter(types))
        .format(Some(SchemaFormat::KnownFormat(KnownFormat::Double)));
    let array = ArrayBuilder::new()
        .items(number)
        .min_items(Some(length))
        .max_items(Some(length))
        .description(Some(description));
    array.into()
}

macro_rules! number_row {
    ($name:ident, $length:literal, $nullable:literal, $description:literal) => {
        impl PartialSchema for $name {
            fn schema() -> RefOr<Schema> {
                numbers($length, $nullable, $description)
            }
        }

        impl ToSchema for $name {}
    };
}

number_row!(Interval, 2, false, "lowest, highest");
number_row!(Triple, 3, false, "x, y, z");
number_row!(PartialTriple, 3, true, "x, y, z, each of which may be null");
number_row!(Matrix4x4, 16, false, "a 4x4 matrix, row by row");
number_row!(Sphere, 4, false, "centre and radius: x, y, z, r");
number_row!(CornerPair, 6, false, "lowest and highest corner: x0, y0, z0, x1, y1, z1");

impl PartialSchema for Intervals {
    fn schema() -> RefOr<Schema> {
        let array = ArrayBuilder::new()
            .items(numbers(2, false, "lowest, highest"))
            .min_items(Some(3))
            .max_items(Some(3))
            .description(Some("for x, y and z the lowest and the highest value"));
        array.into()
    }
}

impl ToSchema for Intervals {}
