//! Prediction of a face after the bones under it are moved: meshes, tissue, equations, solvers, comparisons.
//!
//! The path of one prediction: [`format`] reads meshes and images; a [`prediction::Case`] says what of them is
//! tissue, which nodes are [held](boundary) by bone and of what [material] the tissue is, a [`prediction::Plan`]
//! how bones [move](plan), and [`prediction::Settings`] by which [model] and how exactly. [`prediction::Scene`]
//! checks all of it and says everything that is wrong; [`prediction::predict`] lets the model make its equations of
//! [element]s, the [solver] solve them, and tells what the displacement does to the tissue. [`response`] and
//! [`optimisation`] turn many plans on one case around, [`registration`] and [`validation`] hold a prediction
//! against what was scanned afterwards, [`study`] methods against each other, [`learning`] learns from operated cases, and
//! [`chart`] draws. Nothing here reads
//! a file, a clock or the environment: [`progress`] is how the caller hears and stops.
//!
//! A block of tissue on a jaw that moves forward by 2 mm:
//!
//! ```
//! use mechanics::boundary::NodeSelection;
//! use mechanics::mesh::{CellShape, Vector, sample::block};
//! use mechanics::plan::{PlannedSegment, RigidMovement};
//! use mechanics::prediction::{Case, CaseSegment, Plan, Scene, Settings, predict};
//! use mechanics::{material::LinearElastic, progress::Unobserved};
//!
//! let tissue = block(Vector::new(40.0, 40.0, 10.0), [4, 4, 2], CellShape::Hex8);
//! let jaw = NodeSelection::NodeSet("z_min".to_owned());
//! let case = Case {
//!     volume: tissue.into(),
//!     materials: [("*".to_owned(), LinearElastic::new(15.0, 0.46, 1.0)?)].into(),
//!     segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: jaw }],
//!     allow_unfixed: true,
//!     ..Case::default()
//! };
//! let [level, forward] = [Vector::zeros(), Vector::new(0.0, -2.0, 0.0)];
//! let movement = RigidMovement::about_pivot(level, level, forward);
//! let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
//! let scene = Scene::new(&case, &Plan { segments, ..Plan::default() }, &Settings::default())?;
//! let prediction = predict(&scene, &Unobserved)?;
//! // Nothing else holds the block: all of it goes with the jaw.
//! assert!(prediction.displacement.iter().all(|u| (u - forward).norm() < 1e-4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod anatomy;
pub mod boundary;
pub mod cephalometry;
pub mod chart;
pub mod conformation;
pub mod domain;
pub mod draws;
pub mod element;
pub mod format;
pub mod image;
pub mod landmarks;
pub mod learning;
pub mod material;
pub mod mesh;
pub mod meshing;
pub mod model;
pub mod muscle;
pub mod optimisation;
pub mod osteotomy;
pub mod plan;
pub mod prediction;
pub mod progress;
pub mod registration;
pub mod repair;
pub mod response;
pub mod rows;
pub mod simplification;
pub mod solver;
pub mod study;
pub mod validation;
mod vectorised;
