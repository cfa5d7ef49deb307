//! The pictures of checks, drawn once: kept in memory while there is room, the oldest given up first.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

/// Bytes of all pictures together.
const ROOM: usize = 32 << 20;

/// What was drawn, by its case and by the hash of everything that was asked of it.
#[derive(Clone, Default)]
pub struct Pictures {
    kept: Arc<Mutex<VecDeque<Picture>>>,
}

struct Picture {
    case: String,
    question: String,
    svg: Bytes,
}

impl Pictures {
    /// A picture that was drawn before. Whether its case is still there is for its caller to know.
    pub fn get(&self, case: &str, question: &str) -> Option<Bytes> {
        let kept = self.kept();
        let mut pictures = kept.iter();
        let found = pictures.find(|kept| kept.case == case && kept.question == question);
        found.map(|kept| kept.svg.clone())
    }

    pub fn keep(&self, case: &str, question: String, svg: Bytes) {
        if svg.len() > ROOM || self.get(case, &question).is_some() {
            return;
        }
        let mut kept = self.kept();
        kept.push_back(Picture { case: case.to_owned(), question, svg });
        while kept.iter().map(|picture| picture.svg.len()).sum::<usize>() > ROOM {
            kept.pop_front();
        }
    }

    /// Gives up the pictures of a case that was erased.
    pub fn forget(&self, case: &str) {
        self.kept().retain(|picture| picture.case != case);
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
