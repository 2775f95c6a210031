//! The page of `rodlab view`, requested by the browser and by an unauthorised client.

use std::fs;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use rodlab::RodlabError;
use rodlab::view::View;
use serde_json::{Value, json};

use crate::runs::{Folder, Words, path_of_example};

/// A sheet served by `rodlab view` in a thread.
struct Served {
    folder: Folder,
    sheet: PathBuf,
    host: String,
    path: String,
    interrupted: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<(), RodlabError>>>,
}

impl Served {
    /// A copy of the polypropylene rod of the examples.
    fn of(sheet: &str) -> Self {
        let folder = Folder::of_example("polypropylene");
        let sheet = folder.file(sheet);
        let view = View::of(&sheet, 0).unwrap();
        let address = view.address();
        let address = address.strip_prefix("http://").unwrap();
        let (host, path) = address.split_once('/').unwrap();
        let interrupted = Arc::new(AtomicBool::new(false));
        let (host, path) = (host.to_owned(), format!("/{path}"));
        let flag = Arc::clone(&interrupted);
        Self {
            folder,
            sheet,
            host,
            path,
            thread: Some(thread::spawn(move || view.serve(&flag))),
            interrupted,
        }
    }

    /// Status, head and body of the answer to a request that is written by hand.
    fn answer(&self, request: impl AsRef<[u8]>) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.write_all(request.as_ref()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|end| end == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, head, bytes[end + 4..].to_vec())
    }

    fn get(&self, what: &str) -> (u16, String, Vec<u8>) {
        let (path, host) = (&self.path, &self.host);
        self.answer(format!("GET {path}{what} HTTP/1.1\r\nHost: {host}\r\n\r\n"))
    }

    fn post_from(&self, origin: &str, what: &str, body: &str) -> (u16, String, Vec<u8>) {
        let (path, host, length) = (&self.path, &self.host, body.len());
        self.answer(format!(
            "POST {path}{what} HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nContent-Length: {length}\r\n\r\n{body}"
        ))
    }

    fn post(&self, what: &str, body: &str) -> Value {
        let (status, _, body) = self.post_from(&format!("http://{}", self.host), what, body);
        assert_eq!(status, 200);
        serde_json::from_slice(&body).unwrap()
    }

    fn evaluate(&self, text: &str, quick: bool) -> Value {
        let asked = json!({ "text": text, "quick": quick });
        self.post("evaluate", &asked.to_string())
    }

    /// The answer to a request that replaces the text with this hash by another text.
    fn save(&self, text: &str, was: &Value) -> Value {
        self.post("save", &json!({ "text": text, "was": was }).to_string())
    }

    fn on_disk(&self) -> String {
        fs::read_to_string(&self.sheet).unwrap()
    }

    fn sheet(&self) -> (String, String) {
        let (_, _, body) = self.get("sheet");
        let found: Value = serde_json::from_slice(&body).unwrap();
        let word = |key: &str| found[key].as_str().unwrap().to_owned();
        (word("text"), word("hash"))
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.interrupted.store(true, Ordering::Relaxed);
        let ended = self.thread.take().unwrap().join();
        if !thread::panicking() {
            ended.unwrap().unwrap();
        }
    }
}

/// Other users of the machine, pages of other sites and requests with another host name get no data
/// and change nothing.
#[test]
fn strangers_are_refused() {
    let served = Served::of("rod.toml");
    let (path, host) = (&served.path, &served.host);
    host.must_begin("127.0.0.1:");
    let status = |request: String| served.answer(request).0;
    let get =
        |path: &str, host: &str| status(format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
    assert_eq!(get(path, host), 200);
    assert_eq!(get("/", host), 404);
    assert_eq!(get(&format!("/{}/", "0".repeat(32)), host), 404);
    assert_eq!(get(path, "rebound.example"), 421);
    assert_eq!(status(format!("GET {path} HTTP/1.1\r\n\r\n")), 421);
    assert_eq!(get(&format!("{path}../rod.toml"), host), 404);
    assert_eq!(get(&format!("{path}report/1"), host), 404);
    let (text, hash) = served.sheet();
    let body = json!({ "text": "job = \"frf\"", "was": hash }).to_string();
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
        assert_eq!(served.post_from(origin, "save", &body).0, 403, "{origin}");
    }
    let delete = format!("DELETE {path} HTTP/1.1\r\nHost: {host}\r\n\r\n");
    assert_eq!(status(delete), 405);
    assert_eq!(served.on_disk(), text);
}

/// Bytes that are not a request, or too long, are refused before they are read.
#[test]
fn what_is_no_request_is_refused() {
    let served = Served::of("rod.toml");
    let (path, host) = (&served.path, &served.host);
    assert_eq!(served.answer(b"\x16\x03\x01 no http\r\n\r\n").0, 400);
    let long = "x".repeat(64 << 10);
    let long = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nX: {long}\r\n\r\n");
    assert_eq!(served.answer(long).0, 431);
    for (head, status) in [
        ("Content-Length: 99999999999", 413),
        ("Content-Length: -1", 400),
        ("Transfer-Encoding: chunked", 411),
    ] {
        let request = format!(
            "POST {path}evaluate HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n{head}\r\n\r\n"
        );
        assert_eq!(served.answer(request).0, status, "{head}");
    }
    let own = format!("http://{host}");
    assert_eq!(served.post_from(&own, "rule", "{").0, 400);
    // the next request is answered
    assert_eq!(served.get("").0, 200);
}

/// The page may run its own script and nothing else, and shows the report that the job writes.
#[test]
fn the_page_shows_the_report_of_the_job() {
    let served = Served::of("rod.toml");
    let (_, head, page) = served.get("");
    let page = String::from_utf8(page).unwrap();
    assert!(
        head.contains("default-src 'none'") && !head.contains("unsafe"),
        "{head}"
    );
    assert!(page.contains("<h1>rod.toml</h1>") && !page.contains("{token}"));
    let (text, _) = served.sheet();
    let found = served.evaluate(&text, false);
    let words = ["standing", "headline"];
    assert!(words.iter().all(|word| found[word].is_string()), "{found}");
    let (status, _, report) = served.get(&format!("report/{}", found["report"]));
    assert_eq!(status, 200);
    let folder = served.folder.file("result");
    let run = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["modulus", "--quiet"])
        .arg(&served.sheet)
        .arg("--out")
        .arg(&folder)
        .status()
        .unwrap();
    assert!(run.code().is_some_and(|code| code != 2));
    assert_eq!(report, fs::read(folder.join("report.html")).unwrap());
    // the evaluation without laws has the same headline and is marked as a part
    let quick = served.evaluate(&text, true);
    let parts = [&found, &quick].map(|found| found["isPart"].as_bool().unwrap());
    assert_eq!(parts, [false, true]);
    assert_eq!(quick["headline"], found["headline"]);
    // the places of values are counted in UTF-16 units, as in scripts
    let units: Vec<u16> = text.encode_utf16().collect();
    let mut values = found["values"].as_array().unwrap().iter();
    let length = values.find(|one| one["name"] == "specimen.length").unwrap();
    let place = |key: &str| length[key].as_u64().unwrap() as usize;
    let there = String::from_utf16(&units[place("from")..place("to")]).unwrap();
    there.must_begin("\"");
    there.must_say("mm");
}

#[test]
fn mistakes_are_shown_at_their_lines() {
    let served = Served::of("rod.toml");
    let (text, _) = served.sheet();
    let found = served.evaluate(&text.replace("diameter", "diametre"), true);
    let first = &found["mistakes"][0];
    let line = text.lines().position(|line| line.contains("diameter"));
    assert_eq!(first["line"], line.unwrap() + 1, "{found}");
    first["words"].as_str().unwrap().must_say("diametre");
    let found = served.evaluate("no sheet", true);
    assert!(found["mistakes"].is_array(), "{found}");
    let found = served.evaluate(&text.replace("hits-", "missing-"), true);
    found["wrong"].as_str().unwrap().must_say("missing-");
}

/// A hit rejected by hand is listed as not accepted, with the reason; if the decision is withdrawn,
/// the criteria accept it again.
#[test]
fn hits_are_rejected_and_accepted() {
    for sheet in ["rod.toml", "modulus.ron"] {
        let served = Served::of(sheet);
        let (text, _) = served.sheet();
        let hits = |text: &str| served.evaluate(text, true)["hits"].clone();
        let before = hits(&text);
        assert_eq!(before.as_array().unwrap().len(), 5, "{before}");
        let ruled = |text: &str, ruling: &str| {
            let asked = json!({ "text": text, "hit": 2, "ruling": ruling });
            let answer = served.post("rule", &asked.to_string());
            let text = answer["text"].as_str();
            text.unwrap_or_else(|| panic!("{answer}")).to_owned()
        };
        let without = ruled(&text, "reject");
        let found = hits(&without);
        let accepted = [0, 1, 2, 3, 4].map(|k: usize| found[k]["accepted"].as_bool().unwrap());
        assert_eq!(accepted, [true, false, true, true, true], "{found}");
        let reason = found[1]["reasons"][0].as_str().unwrap();
        reason.must_begin("rejected by hand");
        assert_eq!(hits(&ruled(&without, "criteria")), before);
    }
}

/// The sheet is written to its file, but not over changes that the page has not read, and not if
/// the file is read-only.
#[test]
fn a_sheet_is_saved_but_never_over_a_change_of_another_program() {
    let served = Served::of("rod.toml");
    let (text, hash) = served.sheet();
    let longer = text.replace("title = \"", "title = \"Longer: ");
    assert_ne!(longer, text);
    let saved = served.save(&longer, &hash.into());
    assert_eq!(served.on_disk(), longer, "{saved}");
    // another program writes
    fs::write(&served.sheet, "# mine\n").unwrap();
    let refused = served.save(&text, &saved["hash"]);
    refused["wrong"]
        .as_str()
        .unwrap()
        .must_say("another program");
    assert_eq!(served.on_disk(), "# mine\n");
    // a read-only sheet
    let (_, hash) = served.sheet();
    let mut permissions = fs::metadata(&served.sheet).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&served.sheet, permissions).unwrap();
    let refused = served.save(&text, &hash.into());
    assert!(refused["wrong"].is_string(), "{refused}");
    assert_eq!(served.on_disk(), "# mine\n");
}

/// The command prints the address, serves it, and ends with status 0 when it is interrupted.
#[cfg(unix)]
#[test]
fn the_command_serves_until_it_is_interrupted() {
    use std::io::{BufRead as _, BufReader};

    let sheet = path_of_example("polypropylene/rod.toml");
    let mut child: Child = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .arg("view")
        .arg(&sheet)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    output.read_line(&mut line).unwrap();
    let mut words = line.split(' ');
    let address = words.find_map(|word| word.strip_prefix("http://"));
    let (host, path) = address.unwrap().split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET /{path} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    page.must_begin("HTTP/1.1 200");
    let mut kill = Command::new("kill");
    kill.args(["-INT", &child.id().to_string()]);
    assert!(kill.status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn what_is_no_text_is_not_served() {
    let folder = Folder::new();
    let missing = View::of(&folder.file("missing.toml"), 0).unwrap_err();
    assert!(missing.to_string().contains("missing.toml"), "{missing}");
    let recording = path_of_example("polypropylene/hits-1.npy");
    assert!(matches!(
        View::of(&recording, 0).unwrap_err(),
        RodlabError::NoSheet { .. }
    ));
}
