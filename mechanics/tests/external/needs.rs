//! Needs that are not met: ignored with a reason, or a failure.

use libtest_mimic::Completion;

use crate::support::external::{Missing, REQUIRE_DATA, REQUIRE_SERVERS, completion, trials};

trials! {
    a_test_whose_need_is_not_met_is_ignored_with_the_reason
    a_need_that_is_required_fails_its_test_with_the_reason
}

fn unmet(required_by: Option<&'static str>) -> Result<(), Missing> {
    Err(Missing { why: "made up to be ignored".to_owned(), required_by })
}

fn a_test_whose_need_is_not_met_is_ignored_with_the_reason() {
    for (required_by, set) in [(None, REQUIRE_DATA), (Some(REQUIRE_DATA), REQUIRE_SERVERS)] {
        let found = completion(unmet(required_by), |variable| variable == set).unwrap();
        let Completion::Ignored { reason } = found else { panic!("{required_by:?} is completed") };
        assert_eq!(reason.as_deref(), Some("made up to be ignored"));
    }
    assert!(matches!(completion((), |_| true).unwrap(), Completion::Completed));
}

fn a_need_that_is_required_fails_its_test_with_the_reason() {
    let found = completion(unmet(Some(REQUIRE_DATA)), |variable| variable == REQUIRE_DATA);
    let failed = found.err().unwrap();
    let told = failed.message().unwrap();
    assert_eq!(told, "made up to be ignored, and FACIES_REQUIRE_DATA is set");
}
