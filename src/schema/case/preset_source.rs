//! Source, state and caveats of each material of the literature, in words.

/// Words of one material.
pub(super) struct Words {
    pub name: &'static str,
    pub tissue: &'static str,
    pub authors: &'static str,
    pub year: u32,
    /// The section or table.
    pub place: &'static str,
    pub state: &'static str,
    pub doubt: Option<&'static str>,
}

const CHABANAS: &str = "Chabanas, Luboz, Payan";
const KIM: &str = "Kim, Jürgens, Reyes";
const ZACHOW: &str = "Zachow, Weiser, Hege, Deuflhard";
const ZHANG: &str = "Zhang, Xia, Liebschner, Zhang, Kim, Zhou";

const MANDIBLE: &str =
    "fitted: the theta with which patients operated on the mandible alone were predicted best";
const BOTH_JAWS: &str =
    "fitted: the theta with which patients operated on both jaws were predicted best";
const NEARLY_INCOMPRESSIBLE: &str = "its bulk modulus is above 100 000 times its shear modulus, which elements that take volume at each \
                                     point cannot bear (`locking`), and theta is a fit to few patients";
const NO_CONSENSUS: &str = "nu is the middle and E an end of ranges that matched one patient best; the authors find that fine tuning of \
                            these constants does not change the skin significantly, and moduli from 4.5 to 300 kPa are reported";

pub(super) const TISSUE_CHABANAS: Words = Words {
    name: "tissue_chabanas_2003",
    tissue: "skin, mucosa and fat as one",
    authors: CHABANAS,
    year: 2003,
    place: "section 3.4.2, after Fung 1993",
    state: "measured, at stretches below 15 %; Poisson's ratio as of tissue made of water",
    doubt: None,
};

pub(super) const MUSCLE_AT_REST_CHABANAS: Words = Words {
    name: "muscle_at_rest_chabanas_2003",
    tissue: "muscle at rest",
    authors: CHABANAS,
    year: 2003,
    place: "section 3.4.2, after Duck 1990",
    state: "measured: the same along the fibres and across them while the muscle is at rest",
    doubt: None,
};

pub(super) const MUSCLE_ACTIVE_CHABANAS: Words = Words {
    name: "muscle_active_chabanas_2003",
    tissue: "muscle at its largest activation",
    authors: CHABANAS,
    year: 2003,
    place: "section 3.4.2, after Duck 1990",
    state: "measured: 110 kPa along the fibres at the largest activation, 6.2 kPa across them",
    doubt: Some(
        "it is of a muscle that is wholly contracted; the same source has 6.2 kPa in both directions at rest",
    ),
};

pub(super) const FAT_KIM: Words = Words {
    name: "fat_kim_2012",
    tissue: "fat",
    authors: KIM,
    year: 2012,
    place: "table 2",
    state: "chosen by the authors among values of the literature",
    doubt: None,
};

pub(super) const MUSCLE_KIM: Words = Words {
    name: "muscle_kim_2012",
    tissue: "muscle with fibres",
    authors: KIM,
    year: 2012,
    place: "table 2",
    state: "chosen by the authors; .5 MPa along the fibres, .79 MPa across them, with their law of fibres",
    doubt: Some(
        "the table has muscle softer along its fibres than across them, against measurements (Duck 1990: 110 kPa along, 6.2 kPa across); \
         exchanged, its law would have no lowest energy",
    ),
};

pub(super) const EMBEDDING_ZACHOW: Words = Words {
    name: "embedding_zachow_2006",
    tissue: "fat and connective tissue around muscles",
    authors: ZACHOW,
    year: 2006,
    place: "section 3.5 (E below 50 kPa, nu .44 to .47) and table 1 (fat 20 kPa, Krouskop 1998, Ophir 1999)",
    state: "fitted to the skin of a patient a while after the operation",
    doubt: Some(NO_CONSENSUS),
};

pub(super) const MUSCLE_ZACHOW: Words = Words {
    name: "muscle_zachow_2006",
    tissue: "muscle",
    authors: ZACHOW,
    year: 2006,
    place: "section 3.5 (E above 300 kPa, nu .43 to .45)",
    state: "fitted to the skin of a patient a while after the operation",
    doubt: Some(NO_CONSENSUS),
};

pub(super) const MUSCLE_MANDIBLE_ZHANG: Words = Words {
    name: "muscle_mandible_zhang_2016",
    tissue: "muscle",
    authors: ZHANG,
    year: 2016,
    place: "table 2",
    state: MANDIBLE,
    doubt: Some(NEARLY_INCOMPRESSIBLE),
};

pub(super) const MUSCLE_BOTH_JAWS_ZHANG: Words =
    Words { name: "muscle_both_jaws_zhang_2016", state: BOTH_JAWS, ..MUSCLE_MANDIBLE_ZHANG };

pub(super) const OTHER_MANDIBLE_ZHANG: Words = Words {
    name: "other_mandible_zhang_2016",
    tissue: "soft tissue other than muscle",
    ..MUSCLE_MANDIBLE_ZHANG
};

pub(super) const OTHER_BOTH_JAWS_ZHANG: Words =
    Words { name: "other_both_jaws_zhang_2016", state: BOTH_JAWS, ..OTHER_MANDIBLE_ZHANG };

/// Young's moduli in kPa as `MEASURED` has them: tissue, source, from, to.
pub(super) const MEASURED: [(&str, &str, f64, f64); 12] = [
    ("skin", "Reihnsner 1989", 4000.0, 15000.0),
    ("skin", "Holzapfel 2000", 100.0, 2000.0),
    ("skin", "Elden 1973", 3430.0, 157_000.0),
    ("soft tissue", "Krouskop 1998", 6.8, 110.0),
    ("fat", "Azar 2001", 4.5, 120.0),
    ("fat", "Maass 1999", 20.0, 60.0),
    ("fat", "Krouskop 1998", 20.0, 20.0),
    ("fat", "Ophir 1999", 20.0, 20.0),
    ("muscle", "Reihnsner 1989", 300.0, 300.0),
    ("muscle", "Duck 1991", 6.2, 300.0),
    ("muscle", "Maass 1999", 15.0, 264.0),
    ("muscle", "Levinson 1995", 50.0, 150.0),
];

/// The source table of `MEASURED`.
pub(super) const MEASURED_IN: (&str, u32, &str) = (ZACHOW, 2006, "table 1");
