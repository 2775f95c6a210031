const heard = [];
addEventListener("error", (e) => heard.push(String(e.message)));
addEventListener("unhandledrejection", (e) => heard.push(String(e.reason)));
for (const kind of ["error", "warn"]) console[kind] = (...words) => heard.push(words.join(" "));
