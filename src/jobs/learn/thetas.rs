//! Predictions of an operated case with Rubin and Bodner's tissue, at both ends and in the middle of theta's interval.

use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::predict::Prepared;
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::learning::classes::AtThetas;
use mechanics::learning::measures;
use mechanics::learning::theta::THETAS;
use mechanics::material::LinearElastic;
use mechanics::prediction::{Case, Method, Scene, Settings, equilibrium};

/// How the skin moves with theta 0.5, 1 and 1.5, at finite strain; whatever else the spec asks of its own method is left out.
/// `at` is the place of the case.
pub fn at_thetas(
    prepared: &Prepared,
    at: &Pointer,
    clock: &Observed,
) -> Result<AtThetas, JobError> {
    let [low, high] = THETAS;
    let of = |theta: f64| {
        let case = with_theta(&prepared.case, theta, at)?;
        let settings = Settings {
            method: Method::FemNonlinear,
            contact: prepared.scene.settings.contact,
            estimate: false,
            ..Settings::default()
        };
        let scene = clock
            .prepared(|stop| Ok(Scene::unless_stopped(&case, &prepared.plan, &settings, stop)?))?;
        let (solved, _) = equilibrium(&scene, clock).map_err(|error| clock.judge(error))?;
        clock.check()?;
        Ok::<_, JobError>(measures::skin(&scene, &solved.displacement))
    };
    Ok([of(low)?, of(1.0)?, of(high)?])
}

/// The case with this theta in each tissue of the law.
fn with_theta(case: &Case, theta: f64, at: &Pointer) -> Result<Case, JobError> {
    let refused = |code, detail: String| JobError::from(Problem::at(at, code, detail));
    let mut other = case.clone();
    let mut tissues = 0;
    for material in other.materials.values_mut() {
        let Some(changed) = LinearElastic::with_theta(material, theta) else { continue };
        *material = changed.map_err(|error| refused(ErrorCode::LawMismatch, error.to_string()))?;
        tissues += 1;
    }
    match tissues {
        0 => {
            let detail =
                "no tissue of the case has a law of kind `rubin_bodner`, whose constant theta is";
            Err(refused(ErrorCode::LawMismatch, detail.to_owned()))
        }
        _ => Ok(other),
    }
}
