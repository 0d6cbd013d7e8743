//! Options come back from the words that they are told in.

use clap::{Args, CommandFactory, FromArgMatches, Parser};
use isophote::compare::DrawingArgs;
use isophote::look::LookArgs;
use isophote::view::{ModelArgs, ViewArgs};
use std::collections::BTreeSet;
use std::fmt::Debug;

#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct Alone<A: Args + Debug> {
    #[command(flatten)]
    args: A,
}

/// Options that lines ask for, read back from their words, line by line; together the lines give every option.
fn come_back<A: Args + Debug>(lines: &[&str], words: fn(&A) -> Vec<Vec<String>>)
where
    Alone<A>: Parser,
{
    let mut given = BTreeSet::new();
    for line in lines {
        let read = |words: Vec<String>| {
            let matches =
                Alone::<A>::command().try_get_matches_from(words).unwrap_or_else(|error| panic!("{line}: {error}"));
            Alone::<A>::from_arg_matches(&matches).unwrap_or_else(|error| panic!("{line}: {error}")).args
        };
        let asked = read(line.split_whitespace().map(str::to_owned).collect());
        let told = words(&asked);
        given.extend(told.iter().map(|words| words[0].clone()));
        assert_eq!(format!("{:?}", read(told.concat())), format!("{asked:?}"), "{told:?}");
    }
    let command = Alone::<A>::command();
    let options = command.get_arguments().filter_map(|argument| argument.get_long()).map(|name| format!("--{name}"));
    let missing: Vec<String> = options.filter(|name| !given.contains(name)).collect();
    assert_eq!(missing, [""; 0], "no words for these");
}

#[test]
fn every_option_comes_back_from_its_words() {
    come_back(
        &[
            "",
            "--shade isophotes --bands 0.1 --light -1 2 0.3 --legend --background #0a0b0c",
            "--shade highlight --stripes 5 --stripe-direction -12.5 --background transparent",
            "--shade draft --pull 0 -1 1e-3 --range -1e-7:2.5",
            "--shade mean --range auto --background white",
            "--shade deviation --against old.step",
            "--shade zebra --pattern dots --stripes 9",
            "--shade reflection --environment around.png",
        ],
        LookArgs::words,
    );
    come_back(
        &[
            "",
            "--technique exact --path compute-32 --scheme general --trim texture --mask-px 0.3 --mask-memory 9 --mask-fill earcut",
            "--technique zones --chord 0.7 --normals vertex --level 3 --batch 4 --emit 64 --unbounded 0.5 --adapter llvm",
        ],
        DrawingArgs::words,
    );
    come_back(
        &[
            "",
            "--view top --zoom 2.5 --near 0.25 --lens-shift -0.1 1e-9 --size 3x4",
            "--azimuth -30 --elevation 12.5 --fov 20",
            "--eye 1 2.5 -3 --target 0.1 0 1e-20 --up 0 1 0 --ortho 7",
        ],
        ViewArgs::words,
    );
    come_back(&["a/b.step --strict", "teapot"], ModelArgs::words);
}
