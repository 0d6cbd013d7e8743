//! Judges picked pixels on a thread of its own: a verdict may take seconds, and a window goes on meanwhile.

use crate::stage::{Plan, Stage};
use compare::PixelVerdict;
use gbuffer::GBuffer;
use pipeline::PackedScene;
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use techniques::Prepared;

/// A pixel that is to be judged, with all that the answer depends on.
pub struct Question {
    /// What is shown.
    pub model: Model,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// How it is drawn.
    pub plan: Plan,
    /// The faces as they were drawn.
    pub scene: Arc<PackedScene>,
    /// What was drawn of them.
    pub prepared: Arc<dyn Prepared>,
    /// What was drawn.
    pub buffer: Arc<GBuffer>,
    /// Column and row.
    pub at: [usize; 2],
}

/// A verdict, or why there is none.
pub type Answer = Result<PixelVerdict, String>;

impl Question {
    /// Casts the ray, and judges the pixel by it.
    pub fn answer(&self) -> Answer {
        let Self { model, camera, viewport, plan, scene, prepared, buffer, at } = self;
        let stage = Stage::of(model, *camera, *viewport, *plan, scene.clone(), prepared.clone());
        stage.against_ray(&Caster::new(model), buffer, *at).map_err(|error| format!("{error:#}"))
    }
}

/// One question at work, and the last that was asked since: those between the two are of no interest any more.
#[derive(Default)]
pub struct Judging {
    working: Option<Working>,
    next: Option<Question>,
}

struct Working {
    answer: Receiver<Answer>,
    /// Whether the answer is still asked for.
    is_wanted: bool,
}

impl Judging {
    /// Asks; what was asked before is forgotten.
    pub fn ask(&mut self, question: Question) {
        self.forget();
        match self.working {
            Some(_) => self.next = Some(question),
            None => self.begin(question),
        }
    }

    /// Wants no answer any more. A thread that is at work ends by itself.
    pub fn forget(&mut self) {
        self.next = None;
        if let Some(working) = &mut self.working {
            working.is_wanted = false;
        }
    }

    /// Whether an answer is to come.
    pub fn is_awaited(&self) -> bool {
        self.next.is_some() || self.working.as_ref().is_some_and(|working| working.is_wanted)
    }

    /// The answer to the last question, once, where it has come.
    pub fn answered(&mut self) -> Option<Answer> {
        let Working { answer, is_wanted } = self.working.as_ref()?;
        let found = match answer.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(answer) => answer,
            Err(TryRecvError::Disconnected) => Err("the judge has stopped".to_owned()),
        };
        let found = is_wanted.then_some(found);
        self.working = None;
        if let Some(question) = self.next.take() {
            self.begin(question);
        }
        found
    }

    fn begin(&mut self, question: Question) {
        let (sender, answer) = channel();
        // Who asked may be gone when the answer comes.
        std::thread::spawn(move || drop(sender.send(question.answer())));
        self.working = Some(Working { answer, is_wanted: true });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn question(size: usize, at: [usize; 2]) -> Question {
        let model = models::builtin("teapot").expect("built in");
        let viewport = Viewport::new(size, size).expect("a size");
        let (camera, plan) = (Camera::framing(&model, viewport), Plan::default());
        let stage = Stage::new(&model, camera, viewport, plan).expect("a stage");
        let (scene, prepared) = (stage.scene.clone(), stage.prepared.clone());
        let buffer = Arc::new(stage.raster());
        Question { model, camera, viewport, plan, scene, prepared, buffer, at }
    }

    fn awaited(judging: &mut Judging) -> Answer {
        let begun = Instant::now();
        loop {
            if let Some(answer) = judging.answered() {
                return answer;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "no answer comes");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn who_asks_goes_on_and_has_the_same_answer_later() {
        let mut judging = Judging::default();
        let asked = question(48, [24, 24]);
        let exact = asked.answer().expect("a verdict");
        judging.ask(asked);
        assert!(judging.is_awaited());
        assert_eq!(awaited(&mut judging), Ok(exact));
        assert!(!judging.is_awaited() && judging.answered().is_none());
    }

    #[test]
    fn only_the_last_of_many_questions_is_answered() {
        let mut judging = Judging::default();
        let last = question(48, [30, 24]);
        let exact = last.answer();
        for x in [20, 22, 24] {
            judging.ask(question(48, [x, 24]));
        }
        judging.ask(last);
        assert_eq!(awaited(&mut judging), exact);
        judging.ask(question(48, [20, 24]));
        judging.forget();
        assert!(!judging.is_awaited());
        let begun = Instant::now();
        while judging.working.is_some() && begun.elapsed() < Duration::from_secs(60) {
            assert!(judging.answered().is_none(), "nobody asks any more");
        }
    }

    #[test]
    fn a_question_that_fits_no_picture_is_answered_by_what_is_wrong() {
        let wrong = Question { buffer: question(32, [1, 1]).buffer, ..question(48, [24, 24]) };
        let mut judging = Judging::default();
        judging.ask(wrong);
        assert!(awaited(&mut judging).is_err());
    }
}
