//! Campaigns with tests in doubt and refused tests among answered ones.

use super::*;
use crate::runs::{Folder, Words, path_of_example};

/// The rod of the examples as it was measured, and with a sensor that is wired the other way round.
fn right_and_inverted() -> Folder {
    let folder = Folder::new();
    let example = path_of_example("polypropylene");
    for name in ["right", "inverted"] {
        let test = folder.file("campaign").join(name);
        fs::create_dir_all(&test).unwrap();
        for number in 1..=5 {
            let hit = format!("hits-{number}.npy");
            fs::copy(example.join(&hit), test.join(&hit)).unwrap();
        }
        let sheet = fs::read_to_string(example.join("modulus.ron")).unwrap();
        let wired = "(name: \"free end\", from: 2, unit: \"m/s2\"";
        sheet.must_say(wired);
        let sheet = match name {
            "inverted" => sheet.replace(wired, &format!("{wired}, inverted: true")),
            _ => sheet,
        };
        fs::write(test.join("modulus.ron"), sheet).unwrap();
    }
    folder
}

#[test]
fn r11_an_inverted_sensor_is_in_doubt_in_one_word_everywhere() {
    let folder = right_and_inverted();
    let run = folder.rodlab("batch campaign --out results");
    let said = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{said}{}", text(&run.stderr));
    said.must_say("in doubt     inverted/modulus: the Kramers-Kronig check fails");
    said.must_say("answered     right/modulus: E' = 2.728");
    said.must_say("2 tests: 1 answered, 1 in doubt, 0 not allowed, 0 wrong input; 2 with warnings");
    let read = |name: &str| folder.read(format!("results/{name}"));
    let summary = read("summary.csv");
    summary.must_begin("test,job,title,status,warnings,result\n");
    summary.must_say_all(&[",in doubt,", ",answered,"]);
    let page = read("index.html");
    page.must_say("<td class=\"status in-doubt\">in doubt</td>");
    page.must_say("<td class=\"status answered\">answered</td>");
    let json = folder.json("results/summary.json");
    assert_eq!(json["in_doubt"], 1);
    assert_eq!(json["with_warnings"], 2);
    assert_eq!(json["tests"][0]["status"], "in doubt");
    assert!(json["tests"][0]["warnings"].as_u64().unwrap() > 0);
    let result = folder.json("results/inverted/modulus/result.json");
    assert_eq!(result["verdict"]["answer"], "in doubt");
    let report = read("inverted/modulus/report.html");
    report.must_say("<p class=\"standing in-doubt\">in doubt</p>");

    // no quantity of the inverted test is valid; its law is fitted nevertheless
    let (mut of_inverted, mut of_law, mut valid_of_right) = (0, 0, 0);
    for line in read("quantities.csv").lines().skip(1) {
        let is_check = line.contains(",\"check: ");
        let (valid, in_doubt) = (line.contains(",true,"), line.ends_with(",in doubt"));
        if line.starts_with("inverted/") {
            assert!(in_doubt && (is_check || !valid), "{line}");
            of_inverted += 1;
            of_law += usize::from(line.contains("Zener"));
        } else {
            assert!(line.ends_with(",answered"), "{line}");
            valid_of_right += usize::from(valid);
        }
    }
    assert!(
        of_inverted > 10 && of_law > 0 && valid_of_right > 10,
        "{of_inverted} {of_law} {valid_of_right}"
    );

    let single = folder.rodlab("modulus campaign/inverted/modulus.ron --out single");
    assert_eq!(single.status.code(), Some(3));
    text(&single.stderr).must_begin("in doubt: the Kramers-Kronig check fails");
    let said = text(&single.stdout);
    said.must_begin("Do not use this result until the failed checks are explained: the Kramers-Kronig check fails");
    said.must_say("\nin doubt; ");

    // on a terminal, where both streams appear, the doubt is stated once
    #[cfg(target_os = "linux")]
    {
        let program = env!("CARGO_BIN_EXE_rodlab");
        let command = format!("{program} modulus campaign/inverted/modulus.ron --out single");
        let terminal = Command::new("script")
            .args(["-qec", &command, "/dev/null"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = text(&terminal.stdout);
        assert_eq!(terminal.status.code(), Some(3), "{said}");
        assert!(
            said.contains("explained: the Kramers-Kronig check fails")
                && !said.contains("in doubt: the Kramers-Kronig check fails"),
            "{said}"
        );
    }
}

#[test]
fn r11_a_campaign_that_was_merged_or_taken_up_has_the_same_standings() {
    let folder = right_and_inverted();
    folder.rodlab("batch campaign --out results");
    let before = folder.read("results/summary.json");
    for again in [
        &["batch", "campaign", "--out", "results", "--resume"][..],
        &["merge", "results"][..],
    ] {
        let run = rodlab(folder.path(), again);
        assert_eq!(run.status.code(), Some(3), "{again:?}");
        let after = folder.read("results/summary.json");
        assert_eq!(after, before, "{again:?}");
    }
}

#[test]
fn r10_a_hit_that_is_there_twice_stops_its_test_and_no_other() {
    let folder = right_and_inverted();
    let test = folder.file("campaign/inverted");
    fs::copy(test.join("hits-2.npy"), test.join("hits-7.npy")).unwrap();
    let run = folder.rodlab("batch campaign --out results");
    let said = text(&run.stdout);
    assert_eq!(run.status.code(), Some(2), "{said}");
    said.must_say("wrong input  inverted/modulus: hits-2.npy and hits-7.npy have the same content: they are one measurement");
    let check = folder.rodlab("check campaign/inverted/modulus.ron");
    assert_eq!(
        check.status.code(),
        Some(2),
        "found before anything is computed"
    );
}

#[test]
fn r10_one_shot_under_two_names_is_no_second_test() {
    let folder = Folder::new();
    let example = path_of_example("nylon");
    for name in ["identify.ron", "shots-1.csv"] {
        fs::copy(example.join(name), folder.file(name)).unwrap();
    }
    fs::copy(example.join("shots-1.csv"), folder.file("shots-2.csv")).unwrap();
    let run = folder.rodlab("check identify.ron");
    assert_eq!(run.status.code(), Some(2));
    text(&run.stderr).must_say("shots-1.csv and shots-2.csv have the same content");
}
