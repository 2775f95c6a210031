//! Requests and answers of HTTP/1.1, one per connection, for a page that a program serves to the
//! browser on the same machine.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

/// Maximum number of bytes of the head of a request.
const MOST_OF_HEAD: usize = 16 << 10;
/// Maximum number of bytes of the body of a request, which is the text of a sheet.
const MOST_OF_BODY: usize = 4 << 20;
/// Maximum number of headers of a request; browsers send about twenty.
const MOST_HEADERS: usize = 64;
/// Longest wait for the next data of a request, and for the browser to accept data of an answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// Longest wait for further data of a request after the answer has been sent.
const LINGER: Duration = Duration::from_secs(1);

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: String,
    pub(super) path: String,
    /// Host that the browser addresses.
    pub(super) host: Option<String>,
    /// Page that sends the request; browsers state it with every POST.
    pub(super) origin: Option<String>,
    pub(super) body: Vec<u8>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    status: &'static str,
    content_type: &'static str,
    /// Content security policy of a page.
    policy: Option<String>,
    body: Vec<u8>,
}

impl Answer {
    pub(super) fn page(html: String, policy: Option<String>) -> Self {
        Self {
            status: "200 OK",
            content_type: "text/html; charset=utf-8",
            policy,
            body: html.into_bytes(),
        }
    }

    pub(super) fn json(value: &serde_json::Value) -> Self {
        Self {
            status: "200 OK",
            content_type: "application/json",
            policy: None,
            body: value.to_string().into_bytes(),
        }
    }

    /// Creates the answer that refuses a request; `status` states the reason.
    pub(super) fn refused(status: &'static str) -> Self {
        Self {
            status,
            content_type: "text/plain; charset=utf-8",
            policy: None,
            body: status.as_bytes().to_vec(),
        }
    }

    /// Writes the answer. Its headers prevent the browser from storing it, and other pages from
    /// framing or reading it.
    pub(super) fn write(&self, stream: &mut TcpStream) -> io::Result<()> {
        let policy = self.policy.as_ref();
        let policy = policy.map_or(String::new(), |policy| {
            format!("Content-Security-Policy: {policy}\r\n")
        });
        let head = format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             Referrer-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: SAMEORIGIN\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\n{policy}\r\n",
            self.status,
            self.content_type,
            self.body.len(),
        );
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.write_all(head.as_bytes())?;
        stream.write_all(&self.body)?;
        stream.flush()?;
        // the rest of the request is read, because the answer may be lost if the connection is
        // closed with unread data
        stream.shutdown(Shutdown::Write)?;
        stream.set_read_timeout(Some(LINGER))?;
        let mut rest = stream.take(MOST_OF_BODY as u64);
        io::copy(&mut rest, &mut io::sink()).map(|_| ())
    }
}

/// Reads the request of a connection. If the data are no request, or the request is too long,
/// returns the answer that refuses it.
pub(super) fn read(stream: &mut TcpStream) -> Result<Request, Answer> {
    let cut = |_| Answer::refused("408 Request Timeout");
    stream.set_read_timeout(Some(PATIENCE)).map_err(cut)?;
    let mut bytes = Vec::new();
    let mut buffer = vec![0; 16 << 10];
    let mut more = |bytes: &mut Vec<u8>| match stream.read(&mut buffer) {
        Ok(0) | Err(_) => Err(Answer::refused("400 Bad Request")),
        Ok(count) => {
            bytes.extend_from_slice(buffer.get(..count).unwrap_or_default());
            Ok(())
        }
    };
    let (mut request, length, head) = loop {
        if let Some(parsed) = parsed(&bytes)? {
            break parsed;
        }
        if bytes.len() > MOST_OF_HEAD {
            return Err(Answer::refused("431 Request Header Fields Too Large"));
        }
        more(&mut bytes)?;
    };
    if length > MOST_OF_BODY {
        return Err(Answer::refused("413 Content Too Large"));
    }
    while bytes.len() < head + length {
        more(&mut bytes)?;
    }
    request.body = bytes.get(head..head + length).unwrap_or_default().to_vec();
    Ok(request)
}

/// Returns the request, the length of its body and the length of its head; `None` if the head is
/// not complete.
fn parsed(bytes: &[u8]) -> Result<Option<(Request, usize, usize)>, Answer> {
    let bad = || Answer::refused("400 Bad Request");
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut found = httparse::Request::new(&mut headers);
    let head = match found.parse(bytes) {
        Ok(httparse::Status::Complete(head)) => head,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(_) => return Err(bad()),
    };
    let (Some(method), Some(path)) = (found.method, found.path) else {
        return Err(bad());
    };
    let header = |name: &str| {
        let mut headers = found.headers.iter();
        let header = headers.find(|header| header.name.eq_ignore_ascii_case(name));
        header.map(|header| String::from_utf8_lossy(header.value).into_owned())
    };
    // a body without stated length is refused: browsers state the length of the data that a page
    // sends
    if header("transfer-encoding").is_some() {
        return Err(Answer::refused("411 Length Required"));
    }
    let length = header("content-length").map_or(Ok(0), |length| length.trim().parse());
    let request = Request {
        method: method.to_owned(),
        path: path.to_owned(),
        host: header("host"),
        origin: header("origin"),
        body: Vec::new(),
    };
    Ok(Some((request, length.map_err(|_| bad())?, head)))
}
