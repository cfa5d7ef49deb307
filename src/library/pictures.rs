//! The pictures of checks and of jobs, drawn once: kept in memory while there is room, the oldest given up first.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

/// Bytes of all pictures together.
const ROOM: usize = 32 << 20;

/// What was drawn: of a case by the hash of everything that was asked of it, of a job by its name.
#[derive(Clone, Default)]
pub struct Pictures {
    kept: Arc<Mutex<VecDeque<Picture>>>,
}

struct Picture {
    /// The case or the job.
    of: String,
    question: String,
    /// The case with which it is erased.
    case: String,
    svg: Bytes,
}

impl Pictures {
    /// A picture that was drawn before. Whether its case or job is still there is for its caller to know.
    pub fn get(&self, of: &str, question: &str) -> Option<Bytes> {
        let kept = self.kept();
        let mut pictures = kept.iter();
        let found = pictures.find(|kept| kept.of == of && kept.question == question);
        found.map(|kept| kept.svg.clone())
    }

    /// Keeps the picture of a case.
    pub fn keep(&self, case: &str, question: String, svg: Bytes) {
        self.put(Picture { of: case.to_owned(), question, case: case.to_owned(), svg });
    }

    /// Keeps the picture of a job, which goes with the case of the job as well.
    pub fn keep_job_picture(&self, job: &str, case: Option<&str>, name: &str, svg: Bytes) {
        let case = case.unwrap_or_default().to_owned();
        self.put(Picture { of: job.to_owned(), question: name.to_owned(), case, svg });
    }

    fn put(&self, picture: Picture) {
        if picture.svg.len() > ROOM || self.get(&picture.of, &picture.question).is_some() {
            return;
        }
        let mut kept = self.kept();
        kept.push_back(picture);
        while kept.iter().map(|picture| picture.svg.len()).sum::<usize>() > ROOM {
            kept.pop_front();
        }
    }

    /// Gives up the pictures of a case or a job that was erased.
    pub fn forget(&self, id: &str) {
        self.kept().retain(|picture| picture.case != id && picture.of != id);
    }

    fn kept(&self) -> MutexGuard<'_, VecDeque<Picture>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_that_of_its_case_and_question_until_its_case_is_erased() {
        let pictures = Pictures::default();
        pictures.keep("a", "still".to_owned(), Bytes::from_static(b"1"));
        pictures.keep("b", "still".to_owned(), Bytes::from_static(b"2"));
        pictures.keep("a", "moved".to_owned(), Bytes::from_static(b"3"));
        let shown = |case, question| pictures.get(case, question);
        assert_eq!(shown("a", "still"), Some(Bytes::from_static(b"1")));
        assert_eq!(shown("b", "still"), Some(Bytes::from_static(b"2")));
        assert_eq!(shown("b", "moved"), None);
        pictures.forget("a");
        assert_eq!((shown("a", "still"), shown("a", "moved")), (None, None));
        assert_eq!(shown("b", "still"), Some(Bytes::from_static(b"2")));
    }

    #[test]
    fn the_pictures_of_a_job_go_with_it_and_with_its_case() {
        let pictures = Pictures::default();
        let there = || ["1", "2"].map(|job| pictures.get(job, "classes.svg").is_some());
        for job in ["1", "2"] {
            pictures.keep_job_picture(job, Some("a"), "classes.svg", Bytes::from_static(b"x"));
        }
        assert_eq!(there(), [true, true]);
        pictures.forget("1");
        assert_eq!(there(), [false, true]);
        pictures.forget("a");
        assert_eq!(there(), [false, false]);
    }

    #[test]
    fn the_oldest_pictures_make_room_and_one_that_is_too_large_is_not_kept() {
        let pictures = Pictures::default();
        let third = Bytes::from(vec![b' '; ROOM / 3]);
        for question in ["1", "2", "3", "4"] {
            pictures.keep("a", question.to_owned(), third.clone());
        }
        let kept = ["1", "2", "3", "4"].map(|question| pictures.get("a", question).is_some());
        assert_eq!(kept, [false, true, true, true]);
        pictures.keep("a", "5".to_owned(), Bytes::from(vec![b' '; ROOM + 1]));
        assert!(pictures.get("a", "5").is_none() && pictures.get("a", "2").is_some());
    }
}
