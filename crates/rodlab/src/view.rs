//! Page with a sheet and its result side by side, which this program serves to a browser on the
//! same machine.
//!
//! The text of the sheet can be edited by typing, by dragging one of its values, and by accepting
//! or rejecting a hit. Each change is evaluated at once, and the page shows the report that the job
//! would write. Saving writes only the sheet, and no result.
//!
//! The server listens on 127.0.0.1 only. It answers a request if the request names this host and
//! its path begins with a random token, which is part of the address that the program prints. A
//! request that changes anything must also come from the page itself.

mod http;

use std::fmt::Write as _;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use labio::ContentHash;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use self::http::{Answer, Request};
use crate::batch::in_one_line;
use crate::finished::identity_of;
use crate::job::{self, Sheet, Silent};
use crate::sheet::edit::{self, Ruling};
use crate::{InStep, RodlabError, output, sheet};

const PAGE: &str = include_str!("view/page.html");
const STYLE: &str = include_str!("view/page.css");
const SCRIPT: &str = include_str!("view/page.js");

/// Time between two checks for a connection.
const TICK: Duration = Duration::from_millis(10);
/// Stack size of a thread that runs a job, equal to the usual size of a main thread.
const STACK: usize = 8 << 20;
/// Number of random bytes of the token, enough to prevent guessing.
const TOKEN: usize = 16;

/// A sheet that is served.
#[derive(Debug)]
pub struct View {
    listener: TcpListener,
    served: Arc<Served>,
}

impl View {
    /// Prepares the page of the sheet at `path`, on a port of 127.0.0.1 (0 for any free port).
    ///
    /// # Errors
    ///
    /// [`RodlabError`] if the sheet cannot be read as text or is a recording, or if the port is not
    /// available. A sheet with mistakes is no error: the page shows the mistakes.
    pub fn of(path: &Path, port: u16) -> Result<Self, RodlabError> {
        sheet::text(path)?;
        if let Err(error @ RodlabError::NoSheet { .. }) = Sheet::read(path) {
            return Err(error);
        }
        let no_port = |error| RodlabError::step("opening a port for the browser", error);
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(no_port)?;
        listener.set_nonblocking(true).map_err(no_port)?;
        let host = listener.local_addr().map_err(no_port)?.to_string();
        let mut random = [0_u8; TOKEN];
        getrandom::fill(&mut random).in_step("generating a token")?;
        let token = random.iter().fold(String::new(), |mut token, byte| {
            let _ = write!(token, "{byte:02x}");
            token
        });
        Ok(Self {
            listener,
            served: Arc::new(Served {
                path: path.to_path_buf(),
                host,
                token,
                latest: AtomicU64::new(0),
                running: Mutex::default(),
                report: Mutex::default(),
                saving: Mutex::default(),
            }),
        })
    }

    /// Returns the address of the page, with its token.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.served.host, self.served.token)
    }

    /// Serves the page until `interrupted` is set.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] if no more connections can be accepted.
    pub fn serve(&self, interrupted: &AtomicBool) -> Result<(), RodlabError> {
        let failed = |error| RodlabError::step("waiting for the browser", error);
        while !interrupted.load(Ordering::Relaxed) {
            match self.listener.accept() {
                Ok((stream, _)) => {
                    let served = Arc::clone(&self.served);
                    let work = move || served.converse(stream);
                    let thread = thread::Builder::new().stack_size(STACK);
                    thread.spawn(work).map_err(failed)?;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => thread::sleep(TICK),
                // only this connection was closed; the server continues
                Err(error) if error.kind() == ErrorKind::ConnectionAborted => {}
                Err(error) => return Err(failed(error)),
            }
        }
        self.served.stop();
        Ok(())
    }
}

/// State shared by the threads of the connections.
#[derive(Debug)]
struct Served {
    path: PathBuf,
    /// Address and port, in the form that browsers state.
    host: String,
    token: String,
    /// Number of the latest requested evaluation.
    latest: AtomicU64,
    /// Flag that stops the running evaluation.
    running: Mutex<Arc<AtomicBool>>,
    /// The latest report, and the number of its evaluation.
    report: Mutex<(u64, String)>,
    saving: Mutex<()>,
}

/// Request of a page for the result of a text.
#[derive(Deserialize)]
struct EvaluateRequest {
    text: String,
    /// True while a value is being dragged; parts that take long are then left out.
    quick: bool,
}

/// Request of a page to accept or reject a hit.
#[derive(Deserialize)]
struct RuleRequest {
    text: String,
    hit: usize,
    ruling: String,
}

/// Request of a page to save a sheet: the new text, and the hash of the file that the page has
/// read.
#[derive(Deserialize)]
struct SaveRequest {
    text: String,
    was: String,
}

impl Served {
    fn converse(&self, mut stream: TcpStream) {
        // a connection may be non-blocking like its listener
        if stream.set_nonblocking(false).is_err() {
            return;
        }
        let answer =
            http::read(&mut stream).map_or_else(|refusal| refusal, |request| self.answer(&request));
        // a browser that has closed the connection needs no answer
        let _ = answer.write(&mut stream);
    }

    fn answer(&self, request: &Request) -> Answer {
        if request.host.as_ref() != Some(&self.host) {
            return Answer::refused("421 Misdirected Request");
        }
        let prefix = format!("/{}/", self.token);
        let Some(what) = request.path.strip_prefix(&prefix) else {
            return Answer::refused("404 Not Found");
        };
        let own = format!("http://{}", self.host);
        if request.method == "POST" && request.origin.as_ref() != Some(&own) {
            return Answer::refused("403 Forbidden");
        }
        match (request.method.as_str(), what) {
            ("GET", "") => self.page(),
            ("GET", what) if what.starts_with("report/") => {
                let (number, report) = &*locked(&self.report);
                if what.strip_prefix("report/") == Some(&number.to_string()) {
                    Answer::page(report.clone(), None)
                } else {
                    Answer::refused("404 Not Found")
                }
            }
            ("GET", "sheet") => Answer::json(&match sheet::text(&self.path) {
                Ok(text) => json!({ "text": text, "hash": hash_of(&text) }),
                Err(error) => json!({ "wrong": in_one_line(&error) }),
            }),
            ("POST", "evaluate") => posted(request, |asked| Answer::json(&self.evaluate(&asked))),
            ("POST", "rule") => posted(request, |asked| rule(&asked)),
            ("POST", "save") => posted(request, |asked| Answer::json(&self.save(&asked))),
            ("GET" | "POST", _) => Answer::refused("404 Not Found"),
            _ => Answer::refused("405 Method Not Allowed"),
        }
    }

    fn page(&self) -> Answer {
        let token = &self.token;
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let escaped = name
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('"', "&quot;");
        let html = PAGE
            .replace("{name}", &escaped)
            .replace("{token}", token)
            .replace("{style}", STYLE)
            .replace("{script}", SCRIPT);
        let policy = format!(
            "default-src 'none'; script-src 'nonce-{token}'; style-src 'nonce-{token}'; connect-src 'self'; frame-src 'self'; \
             form-action 'none'; base-uri 'none'; frame-ancestors 'none'"
        );
        Answer::page(html, Some(policy))
    }

    /// Evaluates the sheet with this text. A later evaluation stops an earlier one.
    fn evaluate(&self, asked: &EvaluateRequest) -> Value {
        let text = &asked.text;
        let number = 1 + self.latest.fetch_add(1, Ordering::Relaxed);
        let flag = Arc::new(AtomicBool::new(false));
        std::mem::replace(&mut *locked(&self.running), Arc::clone(&flag))
            .store(true, Ordering::Relaxed);
        let begun = Instant::now();
        let values: Vec<Value> = edit::leaves(text)
            .into_iter()
            .map(|leaf| {
                let before = text.get(..leaf.place.start).unwrap_or_default();
                let own = text.get(leaf.place).unwrap_or_default();
                let from = in_utf16(before);
                json!({ "name": leaf.name, "from": from, "to": from + in_utf16(own) })
            })
            .collect();
        let mut found = match self.outcome(asked, &flag, number) {
            Ok(found) => found,
            Err(RodlabError::Interrupted) => json!({ "overtaken": true }),
            Err(RodlabError::Sheet(error)) => {
                let all = std::iter::once(&*error).chain(error.others());
                let mistakes: Vec<Value> = all
                    .map(|one| json!({ "line": one.line(), "column": one.column(), "words": one.in_words(), "advice": one.advice() }))
                    .collect();
                json!({ "mistakes": mistakes })
            }
            Err(error) => json!({ "wrong": in_one_line(&error) }),
        };
        if let Some(found) = found.as_object_mut() {
            found.insert("values".to_owned(), values.into());
            let milliseconds = u64::try_from(begun.elapsed().as_millis()).unwrap_or(u64::MAX);
            found.insert("milliseconds".to_owned(), milliseconds.into());
        }
        found
    }

    /// Runs the job of a text and stores the report.
    fn outcome(
        &self,
        asked: &EvaluateRequest,
        flag: &AtomicBool,
        number: u64,
    ) -> Result<Value, RodlabError> {
        let mut job = job::parse(&self.path, &asked.text)?;
        let is_part = asked.quick && job.leave_out_what_takes_long();
        let sheet = Sheet {
            path: self.path.clone(),
            text: asked.text.clone(),
            job,
        };
        let outcome = job::run(&sheet, &Silent, flag)?;
        if flag.load(Ordering::Relaxed) {
            return Err(RodlabError::Interrupted);
        }
        let reads: Vec<PathBuf> = outcome
            .inputs
            .iter()
            .map(|input| sheet.folder().join(&input.path))
            .collect();
        let report = output::report_of(&outcome, &identity_of(&sheet), &reads)?;
        let mut latest = locked(&self.report);
        if latest.0 < number {
            *latest = (number, report);
        }
        drop(latest);
        let hits: Vec<Value> = outcome
            .log
            .iter()
            .filter_map(|entry| {
                let number = entry.what.strip_prefix("hit ")?;
                let number = number.split(|c: char| !c.is_ascii_digit()).next()?;
                Some(json!({
                    "hit": number.parse::<usize>().ok()?,
                    "what": entry.what,
                    "accepted": entry.accepted,
                    "reasons": entry.reasons,
                }))
            })
            .collect();
        let standing = outcome.verdict.standing();
        Ok(json!({
            "standing": standing.word(),
            "headline": outcome.verdict.headline(&outcome.summary),
            "hits": hits,
            "report": number,
            "isPart": is_part,
        }))
    }

    /// Writes the sheet, unless the file has changed since the page read it.
    fn save(&self, asked: &SaveRequest) -> Value {
        let _one_at_a_time = locked(&self.saving);
        let there = match sheet::text(&self.path) {
            Ok(text) => text,
            Err(error) => return json!({ "wrong": in_one_line(&error) }),
        };
        if hash_of(&there) != asked.was {
            return json!({ "wrong": "the file has been changed by another program: load it again, or save your text elsewhere" });
        }
        match output::write_whole(&self.path, asked.text.as_bytes()) {
            Ok(()) => json!({ "hash": hash_of(&asked.text) }),
            Err(error) => json!({ "wrong": in_one_line(&error) }),
        }
    }

    /// Stops a running evaluation.
    fn stop(&self) {
        locked(&self.running).store(true, Ordering::Relaxed);
    }
}

/// Returns the answer to the request of a page.
fn posted<T: DeserializeOwned>(request: &Request, answer: impl FnOnce(T) -> Answer) -> Answer {
    let asked = serde_json::from_slice(&request.body);
    asked.map_or_else(|_| Answer::refused("400 Bad Request"), answer)
}

/// Returns the text of the sheet with a decision on a hit.
fn rule(asked: &RuleRequest) -> Answer {
    let ruling = match asked.ruling.as_str() {
        "accept" => Ruling::Accept,
        "reject" => Ruling::Reject,
        "criteria" => Ruling::Criteria,
        _ => return Answer::refused("400 Bad Request"),
    };
    Answer::json(&match edit::ruled(&asked.text, asked.hit, ruling) {
        Ok(text) => json!({ "text": text }),
        Err(why) => json!({ "wrong": why }),
    })
}

fn hash_of(text: &str) -> String {
    ContentHash::of(text.as_bytes()).to_string()
}

/// Returns the length of a text in UTF-16 units, which is the length that scripts use.
fn in_utf16(text: &str) -> usize {
    text.encode_utf16().count()
}

/// Locks the guarded value, which is consistent even if a thread has panicked.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
