//! The arguments of the program.

use clap::{Arg, ArgAction, ArgMatches, Command};

pub fn command() -> Command {
    let file = || Arg::new("FILE").required(true).help("a problem file, or a folder of .mtx files");
    let set = || {
        let help = "sets an option of the library, also one of the file";
        Arg::new("set").long("set").value_name("NAME=VALUE").action(ArgAction::Append).help(help)
    };
    let threads = || Arg::new("threads").long("threads").value_name("N").help("as --set threads=N");
    let seconds =
        || Arg::new("time-limit").long("time-limit").value_name("S").help("as --set time_limit=S, seconds");
    let json =
        || Arg::new("json").long("json").action(ArgAction::SetTrue).help("prints JSON in place of tables");
    let log = || {
        let help = "prints the log on standard error";
        Arg::new("log")
            .long("log")
            .value_name("LEVEL")
            .num_args(0..=1)
            .require_equals(true)
            .default_missing_value("phase")
            .value_parser(["result", "phase", "step"])
            .help(help)
    };
    let log_file =
        || Arg::new("log-file").long("log-file").value_name("PATH").help("adds the log to this file");
    let write = || {
        let help = "writes the answer into this folder: u.txt, lambda.txt, mu.txt, lambda_t.txt";
        Arg::new("write").long("write").value_name("FOLDER").help(help)
    };
    let answer = || {
        let help = "the folder of an answer, as solve --write makes it; without it the answer in the folder FILE, if there is one";
        Arg::new("answer").long("answer").value_name("FOLDER").help(help)
    };
    let to =
        Arg::new("TO").required(true).help("the other form: a new file if FILE is a folder, else a folder");
    Command::new("feti-contact")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Solves, checks, shows and converts problem files of feti-contact")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(
            Command::new("solve").about("solves the problem and shows certificate and findings").args([
                file(),
                set(),
                threads(),
                seconds(),
                log(),
                log_file(),
                json(),
                write(),
            ]),
        )
        .subcommand(Command::new("check").about("checks the input, and the certificate of an answer").args([
            file(),
            set(),
            threads(),
            answer(),
            json(),
        ]))
        .subcommand(
            Command::new("show").about("shows what the problem has, and what in it is suspicious").args([
                file(),
                set(),
                threads(),
                seconds(),
                json(),
            ]),
        )
        .subcommand(
            Command::new("convert")
                .about("makes a problem file of a folder of .mtx files, or the other way round")
                .args([file(), to]),
        )
}

/// An argument of one value, where the command has it.
pub fn one<'a>(of: &'a ArgMatches, name: &str) -> Option<&'a str> {
    of.try_get_one::<String>(name).ok().flatten().map(String::as_str)
}

pub fn file(of: &ArgMatches) -> &str {
    one(of, "FILE").unwrap_or_default()
}

/// The options of the library that the arguments set, name and value, in their order.
pub fn options(of: &ArgMatches) -> Result<Vec<(String, String)>, String> {
    let named = [("threads", "threads"), ("time-limit", "time_limit"), ("log-file", "log_file")];
    let mut all: Vec<_> = named
        .into_iter()
        .filter_map(|(argument, option)| Some((option.to_owned(), one(of, argument)?.to_owned())))
        .collect();
    if let Some(level) = one(of, "log").filter(|_| one(of, "log-file").is_some()) {
        all.push(("log_level".to_owned(), level.to_owned()));
    }
    for item in of.get_many::<String>("set").into_iter().flatten() {
        let (name, value) =
            item.split_once('=').ok_or_else(|| format!("--set {item}: NAME=VALUE is missing"))?;
        all.push((name.trim().to_owned(), value.trim().to_owned()));
    }
    Ok(all)
}
