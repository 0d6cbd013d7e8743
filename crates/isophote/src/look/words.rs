//! Which options of a command line ask for a look.

use super::{Behind, LookArgs, Range};
use crate::words::{self, Words};

impl LookArgs {
    /// As they stand on a command line.
    pub fn words(&self) -> Vec<Words> {
        let numbers = [("--bands", self.bands), ("--stripe-direction", self.stripe_direction)];
        let vectors = [("--light", &self.light), ("--pull", &self.pull)];
        let shade = [words::named("--shade", &self.shade)].into_iter();
        let numbers = numbers.into_iter().filter_map(|(name, x)| Some(words::numbers(name, &[x?])));
        let vectors = vectors.into_iter().filter_map(|(name, v)| Some(words::numbers(name, v.as_ref()?)));
        let stripes = self.stripes.iter().map(|count| words::option("--stripes", count));
        let range = self.range.iter().map(|range| match range {
            Range::Auto => words::option("--range", "auto"),
            Range::Given([low, high]) => {
                words::option("--range", format!("{}:{}", words::number(*low), words::number(*high)))
            }
        });
        let behind = self.background.iter().map(|behind| match behind {
            Behind::Colour([r, g, b]) => words::option("--background", format!("#{r:02x}{g:02x}{b:02x}")),
            Behind::Nothing => words::option("--background", "transparent"),
        });
        let pattern = self.pattern.iter().map(|pattern| words::named("--pattern", pattern));
        let environment = self.environment.iter().map(|path| words::option("--environment", path.display()));
        let against = self.against.iter().map(|name| words::option("--against", name));
        let legend = words::flag("--legend", self.legend);
        shade
            .chain(numbers)
            .chain(stripes)
            .chain(pattern)
            .chain(environment)
            .chain(vectors)
            .chain(against)
            .chain(range)
            .chain(legend)
            .chain(behind)
            .collect()
    }
}
