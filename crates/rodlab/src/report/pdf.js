// Conversion of a drawing of this page (paths, text, transforms) to a page of PDF, with two fonts that every PDF reader has.
const SYMBOLS = Object.fromEntries([...[..."αβχδεφγηιϕκλμνοπθρστυϖωξψζ"].map((c, i) => [c, 97 + i]), ...[..."ΑΒΧΔΕΦΓΗΙϑΚΛΜΝΟΠΘΡΣΤΥςΩΞΨΖ"].map((c, i) => [c, 65 + i]),
  ["′", 0xa2], ["≤", 0xa3], ["∞", 0xa5], ["→", 0xae], ["″", 0xb2], ["≥", 0xb3], ["∂", 0xb6], ["≈", 0xbb], ["√", 0xd6]]);
const MARKS = { "‐": 0x2d, "‑": 0x2d, "−": 0x96, "–": 0x96, "—": 0x97, "‘": 0x91, "’": 0x92, "“": 0x93, "”": 0x94, "•": 0x95, "…": 0x85, "€": 0x80, "Œ": 0x8c, "œ": 0x9c, "Š": 0x8a, "š": 0x9a, "Ž": 0x8e, "ž": 0x9e, "Ÿ": 0x9f };

// returns font, code, relative size and rise of a character; null if neither font has it
function letter(c) {
  const code = c.codePointAt(0), [raised, lowered] = ["⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "₀₁₂₃₄₅₆₇₈₉₋₊"].map((all) => all.indexOf(c));
  if (raised >= 0 || lowered >= 0) return { font: 1, code: "0123456789\x96+".charCodeAt(Math.max(raised, lowered)), size: 0.66, rise: raised >= 0 ? 0.36 : -0.16 };
  if (SYMBOLS[c]) return { font: 2, code: SYMBOLS[c], size: 1, rise: 0 };
  if (MARKS[c] || (code > 31 && code < 127) || (code > 159 && code < 256)) return { font: 1, code: MARKS[c] || code, size: 1, rise: 0 };
  const [plain] = c.normalize("NFD");
  return plain === c ? null : letter(plain);
}

// Returns an SVG, whose parts must state all their attributes, as a PDF file `width` millimetres wide, and the characters that the file cannot show.
function pdf(svg, title, width) {
  const root = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  const [x0, y0, wide, high] = root.getAttribute("viewBox").split(" ").map(Number);
  const number = (v) => String(+v.toFixed(3)), points = (width * 72) / 25.4, unit = points / wide;
  const pen = document.createElement("canvas").getContext("2d"), shades = {}, lost = new Set();
  const numbers = (text) => (text.match(/-?[\d.]+/g) || []).map(Number);
  const times = ([a, b, c, d, e, f], [p, q, r, s, t, u]) => [a * p + c * q, b * p + d * q, a * r + c * s, b * r + d * s, a * t + c * u + e, b * t + d * u + f];
  let out = "";

  function outline(d) {
    let x = 0, y = 0, from = [0, 0], text = "";
    const tokens = d.match(/[a-z]|-?[\d.]+/gi) || [], next = () => Number(tokens.shift());
    const go = (operator, ...places) => (text += `${places.map(number).join(" ")} ${operator}\n`);
    for (let command = "M"; tokens.length; ) {
      if (/[a-z]/i.test(tokens[0])) command = tokens.shift();
      const [ox, oy] = command === command.toLowerCase() ? [x, y] : [0, 0];
      switch (command.toUpperCase()) {
        case "Z": [x, y] = from; text += "h\n"; break;
        case "H": x = ox + next(); go("l", x, y); break;
        case "V": y = oy + next(); go("l", x, y); break;
        case "A": { // half a circle: its lower half drawn to the right, or its upper half drawn to the left
          const r = next();
          for (let n = 4; n--; ) next();
          const across = next(), down = Math.sign(across), k = 0.5523 * r * down;
          next();
          go("c", x, y + k, x + across / 2 - k, y + r * down, x + across / 2, y + r * down);
          go("c", x + across / 2 + k, y + r * down, x + across, y + k, x + across, y);
          x += across;
          break;
        }
        default: {
          x = ox + next();
          y = oy + next();
          const begins = command.toUpperCase() === "M";
          go(begins ? "m" : "l", x, y);
          if (begins) { from = [x, y]; command = command === "M" ? "L" : "l"; }
        }
      }
    }
    return text;
  }
  const colour = (part, name, operator) => {
    const value = part.getAttribute(name);
    return value && value !== "none" ? `${numbers(value).slice(0, 3).map((v) => number(v / 255)).join(" ")} ${operator}\n` : "";
  };
  function path(part) {
    const fill = colour(part, "fill", "rg"), stroke = colour(part, "stroke", "RG"), d = part.getAttribute("d");
    if (!d || !(fill || stroke)) return;
    const shade = Number(part.getAttribute("fill-opacity") ?? 1), of = (name) => numbers(part.getAttribute(name) || "");
    if (shade < 1) shades[`G${Math.round(100 * shade)}`] = shade;
    out += `${shade < 1 ? `/G${Math.round(100 * shade)} gs ` : ""}${fill}${stroke}${number(of("stroke-width")[0] ?? 1)} w 1 j [${of("stroke-dasharray").join(" ")}] 0 d\n${outline(d)}${fill ? (stroke ? "B" : "f") : "S"}\n`;
  }
  function words(part, at) {
    const [size] = numbers(part.getAttribute("font-size")), runs = [];
    for (const c of part.textContent.normalize("NFC")) {
      const found = letter(c) || (lost.add(c), letter("?")), last = runs.at(-1);
      pen.font = `${100 * found.size}px Helvetica, Arial, "Liberation Sans", sans-serif`;
      const run = last && last.font === found.font && last.rise === found.rise ? last : (runs.push({ ...found, codes: "", long: 0 }), runs.at(-1));
      run.codes += found.code.toString(16).padStart(2, "0");
      run.long += (pen.measureText(c).width * size) / 100;
    }
    const long = runs.reduce((sum, run) => sum + run.long, 0), share = { middle: 0.5, end: 1 }[part.getAttribute("text-anchor")] || 0;
    const [x, y] = ["x", "y"].map((name) => Number(part.getAttribute(name) || 0)), [a, b, c, d, e, f] = times(at, [1, 0, 0, 1, x - share * long, y]);
    out += `BT ${colour(part, "fill", "rg")}${[a, b, -c, -d, e, f].map(number).join(" ")} Tm\n${runs.map((run) => `/F${run.font} ${number(size * run.size)} Tf ${number(size * run.rise)} Ts <${run.codes}> Tj\n`).join("")}ET\n`;
  }
  function all(parent, at) {
    for (const part of parent.children) {
      let here = at;
      for (const [, name, values] of (part.getAttribute("transform") || "").matchAll(/(\w+)\(([^)]*)\)/g)) {
        const [p, q = 0] = numbers(values), turn = (p * Math.PI) / 180;
        here = times(here, name === "rotate" ? [Math.cos(turn), Math.sin(turn), -Math.sin(turn), Math.cos(turn), 0, 0] : [1, 0, 0, 1, p, q]);
      }
      const clip = /#(.*?)["')]/.exec(part.getAttribute("clip-path") || "");
      const edge = clip && [...root.getElementsByTagName("clipPath")].find((one) => one.id === clip[1]);
      if (part.tagName === "text") words(part, here);
      else if (part.tagName !== "clipPath") {
        // text has its own matrix; all other parts are transformed here
        out += "q\n";
        if (edge) out += `${outline(edge.firstElementChild.getAttribute("d"))}W n\n`;
        if (part.tagName === "path") out += `${here.map(number).join(" ")} cm\n`, path(part);
        else all(part, here);
        out += "Q\n";
      }
    }
  }
  out += `1 1 1 rg 0 0 ${number(points)} ${number(high * unit)} re f\n${[unit, 0, 0, -unit, -x0 * unit, (high + y0) * unit].map(number).join(" ")} cm\n`;
  all(root, [1, 0, 0, 1, 0, 0]);
  const hex = [...`\ufeff${title}`].flatMap((c) => c.split("")).map((c) => c.charCodeAt(0).toString(16).padStart(4, "0")).join("");
  const font = (name, encoding) => `<</Type/Font/Subtype/Type1/BaseFont/${name}${encoding}>>`;
  const objects = ["<</Type/Catalog/Pages 2 0 R>>", "<</Type/Pages/Kids[3 0 R]/Count 1>>",
    `<</Type/Page/Parent 2 0 R/MediaBox[0 0 ${number(points)} ${number(high * unit)}]/Contents 4 0 R/Resources<</Font<</F1 5 0 R/F2 6 0 R>>/ExtGState<<${Object.entries(shades).map(([name, shade]) => `/${name}<</ca ${shade}>>`).join("")}>>>>>>`,
    `<</Length ${out.length}>>\nstream\n${out}endstream`, font("Helvetica", "/Encoding/WinAnsiEncoding"), font("Symbol", ""), `<</Title<${hex}>>>`];
  let text = "%PDF-1.4\n";
  const offsets = objects.map((object, i) => {
    const at = text.length;
    text += `${i + 1} 0 obj\n${object}\nendobj\n`;
    return `${String(at).padStart(10, "0")} 00000 n \n`;
  });
  const size = objects.length + 1;
  text += `xref\n0 ${size}\n0000000000 65535 f \n${offsets.join("")}trailer\n<</Size ${size}/Root 1 0 R/Info 7 0 R>>\nstartxref\n${text.length}\n%%EOF\n`;
  return { text, lost: [...lost] };
}
