// The text of the sheet is the state; the rest of the page follows from it and from the answers of the program.
"use strict";
const id = (name) => document.getElementById(name);
const words = id("words");
const make = (name, properties, ...parts) => {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...parts);
  return element;
};

let saved = "";
let hash = "";
let values = [];
let evaluated = null;
let asking = false;
let rest;
let touched = {};
const before = [];

const ask = async (what, body) => {
  const request = body === undefined ? {} : { method: "POST", body: typeof body === "string" ? body : JSON.stringify(body) };
  const answer = await fetch(what, request);
  if (!answer.ok) throw new Error(answer.status + " " + answer.statusText);
  return answer.json();
};

const complain = (sentences) => id("problems").replaceChildren(...sentences.map((textContent) => make("li", { textContent })));

const stand = (standing, headline) => {
  id("standing").textContent = standing;
  id("standing").className = standing.replace(" ", "-");
  id("headline").textContent = headline;
};

const mark = () => {
  const changed = words.value !== saved;
  id("save").disabled = !changed;
  id("undo").disabled = before.length === 0;
  document.title = (changed ? "* " : "") + document.querySelector("h1").textContent;
};

// Runs one evaluation at a time, and then evaluates the changes made in the meantime. Laws and draws take long, and are
// computed when the text has not been changed for a moment.
const evaluate = async () => {
  clearTimeout(rest);
  if (asking || words.value === evaluated) return;
  asking = true;
  try {
    let found;
    while (words.value !== evaluated) {
      const text = words.value;
      found = await ask("evaluate", { text, quick: evaluated !== null });
      evaluated = text;
      show(found, text === words.value);
    }
    if (found.isPart) rest = setTimeout(evaluateWhole, 700);
  } catch (error) {
    complain(["The program does not respond (" + error.message + "). Is it still running?"]);
  } finally {
    asking = false;
  }
};

const evaluateWhole = async () => {
  if (asking) return;
  const text = words.value;
  try {
    const found = await ask("evaluate", { text, quick: false });
    if (!found.overtaken && text === words.value) show(found, true);
  } catch (error) {
    complain(["The program does not respond (" + error.message + ")."]);
  }
};

const show = (found, isCurrent) => {
  if (found.overtaken) return;
  id("time").textContent = found.milliseconds + " ms" + (found.isPart ? ", laws and draws pending" : "");
  if (isCurrent) showValues(found.values);
  if (found.report === undefined) {
    stand("wrong input", "");
    complain(found.mistakes ? found.mistakes.map((one) => `Line ${one.line}: ${one.words}${one.advice ? " (" + one.advice + ")" : ""}`) : [found.wrong]);
    return;
  }
  complain([]);
  stand(found.standing, found.headline);
  showHits(found.hits);
  showReport(found.report);
};

// Replaces the old report by the new one when the new one is drawn, scrolled to the same position.
const showReport = (number) => {
  const last = id("result").querySelector("iframe:not(.next)");
  id("result").querySelectorAll("iframe.next").forEach((frame) => frame.remove());
  const next = make("iframe", { src: "report/" + number, title: "Report", className: last ? "next" : "" });
  next.addEventListener("load", () => {
    if (!last) return;
    next.contentWindow.scrollTo(0, last.contentWindow.scrollY);
    next.className = "";
    last.remove();
  });
  id("result").append(next);
};

// Stores the text before a change, for undo. Changes of one value within a second count as one change.
const remember = (name) => {
  const now = performance.now();
  if (name === undefined || name !== touched.name || now - touched.at > 1000) before.push(words.value);
  touched = { name, at: now };
};

const change = (text) => {
  if (text === words.value) return;
  remember();
  words.value = text;
  mark();
  evaluate();
};

// A number before a unit, in quotes, or with a decimal point. Bare whole numbers, such as those of channels and hits,
// are excluded.
const quantity = /^(["']\s*|(?=[^"']*\.))([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?=\s|["']?$)/;

const written = (value, like) => {
  const digits = Math.max(3, like.replace(/[eE].*|^[-+]?0*\.?0*|\D/g, "").length);
  return String(Number(value.toPrecision(Math.min(digits, 15))));
};

// Controls are kept where the values have the same names, so that a slider is not lost while it is dragged.
const showValues = (found) => {
  const old = values;
  values = found
    .map((value) => ({ ...value, match: words.value.slice(value.from, value.to).match(quantity) }))
    .filter((value) => value.match);
  const same = old.length === values.length && old.every((one, index) => one.name === values[index].name);
  if (same) {
    values.forEach((value, index) => {
      value.control = old[index].control;
      value.control.set(value);
    });
    return;
  }
  values.forEach((value) => (value.control = control(value)));
  const none = make("p", { className: "soft", textContent: "The sheet states no values." });
  id("values").replaceChildren(...(values.length ? values.map((value) => value.control.row) : [none]));
};

const control = (value) => {
  const name = "value-" + value.name;
  const number = make("input", { type: "text", id: name, spellcheck: false, autocomplete: "off" });
  const slider = make("input", { type: "range", min: -1, max: 1, step: 0.005, value: 0, ariaLabel: "Drag " + value.name });
  const row = make("div", { className: "value" }, make("label", { htmlFor: name, textContent: value.name }), number, slider);
  let own = value;
  let start = null;
  const text = () => words.value.slice(own.from, own.to);
  const put = (next) => {
    const there = text();
    const found = there.match(quantity);
    if (!found) return;
    const place = own.from + found[1].length;
    const longer = next.length - found[2].length;
    const whole = words.value.slice(0, place) + next + words.value.slice(place + found[2].length);
    for (const other of values) if (other.from > own.from) { other.from += longer; other.to += longer; }
    own.to += longer;
    words.value = whole;
    mark();
    evaluate();
  };
  slider.addEventListener("input", () => {
    start ??= text().match(quantity)[2];
    remember(own.name);
    const from = Number(start);
    const part = Number(slider.value);
    // the slider changes a value by a factor of up to two, and a value of 0 by up to one
    put(written(from === 0 ? part : from * 2 ** part, from === 0 ? "0.00" : start));
    number.value = text().replace(/^["']|["']$/g, "");
  });
  slider.addEventListener("change", () => { start = null; slider.value = 0; });
  number.addEventListener("change", () => {
    const there = text();
    const quote = /^["']/.test(there) ? there[0] : "";
    change(words.value.slice(0, own.from) + quote + number.value + quote + words.value.slice(own.to));
  });
  const set = (next) => {
    own = next;
    if (document.activeElement !== number) number.value = text().replace(/^["']|["']$/g, "");
  };
  set(value);
  return { row, set };
};

const showHits = (hits) => {
  const none = make("p", { className: "soft", textContent: "The job has no hits to judge." });
  const rows = hits.map((hit) => {
    const byHand = hit.reasons.some((reason) => /^(accepted|rejected) by hand/.test(reason));
    const ruling = byHand ? "criteria" : hit.accepted ? "reject" : "accept";
    const label = { criteria: "By criteria", reject: "Reject", accept: "Accept" }[ruling];
    const button = make("button", { type: "button", textContent: label, ariaLabel: label + ": " + hit.what });
    button.addEventListener("click", async () => {
      try {
        const answer = await ask("rule", { text: words.value, hit: hit.hit, ruling });
        if (answer.wrong) complain([answer.wrong]);
        else change(answer.text);
      } catch (error) {
        complain(["The program does not respond (" + error.message + ")."]);
      }
    });
    const sentence = make("p", { className: hit.accepted ? "" : "out" }, (hit.accepted ? "✓ " : "✗ ") + [hit.what, ...hit.reasons].join("; "));
    return make("div", { className: "hit" }, button, sentence);
  });
  const at = document.activeElement?.closest?.(".hit");
  const index = at ? [...id("hits").children].indexOf(at) : -1;
  id("hits").replaceChildren(...(rows.length ? rows : [none]));
  id("hits").children[index]?.querySelector("button")?.focus();
};

const load = async () => {
  try {
    const found = await ask("sheet");
    if (found.wrong) return complain([found.wrong]);
    [saved, hash] = [found.text, found.hash];
    if (evaluated === null) words.value = saved;
    else change(saved);
    mark();
    await evaluate();
  } catch (error) {
    complain(["The program does not respond (" + error.message + "). Is it still running?"]);
  }
};

const save = async () => {
  const text = words.value;
  try {
    const answer = await ask("save", { text, was: hash });
    if (answer.wrong) return complain([answer.wrong]);
    [saved, hash] = [text, answer.hash];
    complain([]);
    mark();
  } catch (error) {
    complain(["The sheet is not saved: the program does not respond (" + error.message + ")."]);
  }
};

const undo = () => {
  if (before.length === 0) return;
  words.value = before.pop();
  values = [];
  mark();
  evaluate();
};

const tabs = [...document.querySelectorAll("[role=tab]")];
const select = (tab) => {
  for (const one of tabs) {
    one.ariaSelected = String(one === tab);
    one.tabIndex = one === tab ? 0 : -1;
    id(one.getAttribute("aria-controls")).hidden = one !== tab;
  }
};
tabs.forEach((tab, index) => {
  tab.addEventListener("click", () => select(tab));
  tab.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: tabs.length - 1 }[event.key];
    if (!step) return;
    const next = tabs[(index + step) % tabs.length];
    select(next);
    next.focus();
  });
});

let pause;
words.addEventListener("input", () => {
  mark();
  clearTimeout(pause);
  pause = setTimeout(evaluate, 150);
});
id("load").addEventListener("click", load);
id("save").addEventListener("click", save);
id("undo").addEventListener("click", undo);
document.addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key === "s") {
    event.preventDefault();
    save();
  }
});
window.addEventListener("beforeunload", (event) => { if (words.value !== saved) event.preventDefault(); });
load();
