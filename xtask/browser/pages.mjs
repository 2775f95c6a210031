// Checks reports and `rodlab view` in a browser: at four widths, light, dark and printed; no console messages; use by keyboard alone.
//
//     node pages.mjs PROGRAM [--accept]
//
// PROGRAM is `rodlab`, run on copies of its examples. The content of each report without its numbers is compared with outline.txt;
// `--accept` writes that file.
import chromium from '@sparticuz/chromium';
import puppeteer from 'puppeteer-core';
import { execFileSync, spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const program = path.resolve(process.argv[2]);
const outline = path.join(here, 'outline.txt');
const sheets = [
  ['modulus', 'polypropylene/modulus.ron'],
  ['force', 'cone/force.ron'],
  ['fit', 'epoxy/fit.ron'],
  ['shpb', 'shpb/shpb.ron'],
  ['bar', 'polymer_bar/bar.ron'],
  ['modulus', 'polymer_bar/modulus.ron'],
  ['identify', 'nylon/identify.ron'],
];
const looks = [
  [390, 'light', 'screen'],
  [768, 'dark', 'screen'],
  [1280, 'light', 'screen'],
  [1920, 'dark', 'screen'],
  [680, 'light', 'print'],
];
const faults = [];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'rodlab-pages-'));
fs.cpSync(path.join(here, '../../crates/rodlab/examples'), folder, { recursive: true });

const browser = await puppeteer
  .launch({
    // arguments of a Chromium without graphics, except those that relax the browser's security
    // rules
    args: chromium.args.filter((one) => !/web-security|site-isolation|insecure-content|disable-features/.test(one)).concat('--no-sandbox'),
    executablePath: await chromium.executablePath(),
    headless: 'shell',
  })
  .catch((error) => {
    console.log(`the browser does not start, the pages are not checked: ${error.message.split('\n')[0]}`);
    process.exit(0);
  });

// Returns the faults of the displayed page: a page wider than the window, rows of more than three lines, tables cut off, contrast below AA.
function shown() {
  const wrong = [];
  if (document.documentElement.scrollWidth > innerWidth) wrong.push(`the page is ${document.documentElement.scrollWidth} px wide`);
  for (const row of document.querySelectorAll('tbody tr')) {
    const line = parseFloat(getComputedStyle(row.cells[0]).lineHeight);
    const lines = row.getBoundingClientRect().height / line;
    if (getComputedStyle(row).display === 'table-row' && lines > 3.6) wrong.push(`a row of ${lines.toFixed(1)} lines: ${row.textContent.slice(0, 60)}`);
  }
  for (const box of document.querySelectorAll('.scroll')) {
    if (innerWidth > 1000 && box.offsetParent && !box.closest('details') && box.scrollWidth > box.clientWidth + 1) {
      wrong.push(`a table of ${box.scrollWidth} px in ${box.clientWidth}: ${box.textContent.slice(0, 40)}`);
    }
  }
  const luminance = (colour) => {
    const [r, g, b] = colour.match(/[\d.]+/g).map((part) => (part /= 255) <= 0.03928 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (; element; element = element.parentElement) {
      const colour = getComputedStyle(element).backgroundColor;
      if (!/, 0\)$/.test(colour) && colour !== 'transparent') return colour;
    }
    return 'rgb(255, 255, 255)';
  };
  for (const element of document.querySelectorAll('body *')) {
    const drawn = element instanceof SVGElement;
    const has_text = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if ((!element.offsetParent && !drawn) || element.disabled || /script|style/i.test(element.tagName)) continue;
    if (!has_text && element.tagName !== 'INPUT') continue;
    const colour = drawn ? getComputedStyle(element).fill : getComputedStyle(element).color;
    if (colour === 'none') continue;
    const [a, b] = [luminance(colour), luminance(behind(drawn ? element.closest('div') : element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) wrong.push(`contrast ${ratio.toFixed(2)}: ${element.tagName} ${element.textContent.slice(0, 30)}`);
  }
  return [...new Set(wrong)].slice(0, 8);
}

// Returns headings, figures with their panels and curves, and tables with their columns, in the order of the page.
function structure() {
  const lines = [];
  for (const element of document.querySelectorAll('main h2, main h3, main .plot, main table')) {
    if (element.closest('noscript')) continue;
    const text = (node) => node.textContent.replace(/\s+/g, ' ').trim();
    if (element.matches('.plot')) {
      lines.push(`  figure ${element.dataset.name}`);
      for (const svg of element.querySelectorAll('svg[aria-label]')) {
        const curves = svg.querySelectorAll('path, polyline, circle, rect').length;
        const names = [...svg.parentElement.querySelectorAll('.legend > *')].map(text);
        lines.push(`    ${curves > 0 ? '' : 'EMPTY '}${svg.ariaLabel.split('. ')[0]}${names.length > 0 ? `: ${names.join(', ')}` : ''}`);
      }
    } else if (element.matches('table')) {
      const heads = [...element.querySelectorAll('thead th')].map((head) => [...head.childNodes].map(text).join(', '));
      lines.push(`  table: ${heads.join(' | ')}`);
    } else {
      lines.push(`${'#'.repeat(Number(element.tagName[1]))} ${text(element).replace(/[-\d.,]+/g, 'N')}`);
    }
  }
  return lines;
}

// Checks the first figure by keyboard: an arrow key shows a value, `+` zooms in, Escape resets the zoom.
async function by_keys(page) {
  const wrong = [];
  const panel = (await page.$$('svg[aria-label]'))[0];
  const read = () => panel.evaluate((svg) => [svg.parentElement.querySelector('output').textContent, svg.innerHTML]);
  await panel.evaluate((svg) => svg.focus());
  const [, drawn] = await read();
  await page.keyboard.press('ArrowRight');
  if (!(await read())[0]) wrong.push('an arrow key shows no value');
  await page.keyboard.press('+');
  const [, zoomed] = await read();
  if (zoomed === drawn) wrong.push('plus does not zoom');
  await page.keyboard.press('Escape');
  if ((await read())[1] === zoomed) wrong.push('escape does not reset');
  return wrong;
}

async function opened(width, scheme, media) {
  const page = await browser.newPage();
  const said = [];
  page.on('console', (message) => said.push(`console: ${message.text()}`));
  page.on('pageerror', (error) => said.push(`error: ${error.message}`));
  page.on('dialog', (dialog) => dialog.accept());
  await page.setViewport({ width, height: 900 });
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: scheme }]);
  await page.emulateMediaType(media);
  return [page, said];
}

const outlines = [];
for (const [job, sheet] of sheets) {
  const out = path.join(folder, `${sheet}-result`);
  execFileSync(program, [job, path.join(folder, sheet), '--quiet', '--out', out]);
  for (const [width, scheme, media] of looks) {
    const [page, said] = await opened(width, scheme, media);
    await page.goto(`file://${out}/report.html`);
    said.push(...(await page.evaluate(shown)));
    if (width === 1280) {
      outlines.push(`${job} ${sheet}`, ...(await page.evaluate(structure)), '');
      said.push(...(await by_keys(page)));
    }
    if (media === 'print') {
      for (const format of ['a4', 'letter']) {
        const pdf = Buffer.from(await page.pdf({ format })).toString('latin1');
        const pages = pdf.match(/\/Type\s*\/Page\b/g)?.length ?? 0;
        if (pages < 1 || pages > 14) said.push(`${pages} pages of ${format}`);
      }
    }
    faults.push(...said.map((fault) => `${sheet}, ${width} px, ${scheme}, ${media}: ${fault}`));
    await page.close();
  }
}

await view(path.join(folder, 'polypropylene/modulus.ron'));
await browser.close();
fs.rmSync(folder, { recursive: true });

const found = outlines.join('\n');
if (process.argv.includes('--accept')) fs.writeFileSync(outline, found);
else if (fs.readFileSync(outline, 'utf8') !== found) {
  const kept = new Set(fs.readFileSync(outline, 'utf8').split('\n'));
  const other = outlines.find((line) => !kept.has(line)) ?? 'a line is missing or in another place';
  faults.push(`reports differ from outline.txt: ${other}; check them, then call with --accept`);
}
for (const fault of faults) console.error(fault);
console.log(`${sheets.length} reports at ${looks.length} looks, view at 4 widths: ${faults.length} faults`);
process.exit(faults.length > 0 ? 1 : 0);

// Checks the page of `rodlab view` at each width, then by keyboard alone: a changed value, undo, a rejected hit and the saved sheet.
async function view(sheet) {
  const server = spawn(program, ['view', sheet]);
  const address = await new Promise((resolve) => server.stdout.on('data', (data) => {
    const found = String(data).match(/http:\S+/);
    if (found) resolve(found[0]);
  }));
  const expect = (is, what) => is || faults.push(`view: ${what}`);
  for (const [width, scheme] of looks.filter(([, , media]) => media === 'screen')) {
    const [page, said] = await opened(width, scheme, 'screen');
    const text = (id) => page.$eval(`#${id}`, (element) => element.textContent);
    const until = (is, ...values) => page.waitForFunction(is, { timeout: 60000 }, ...values);
    await page.goto(address);
    await until(() => document.querySelectorAll('iframe').length === 1 && document.getElementById('time').textContent);
    said.push(...(await page.evaluate(shown)));
    expect((await text('standing')) === 'answered', `standing at ${width} px is ${await text('standing')}`);
    if (width === 1280) {
      const before = await text('headline');
      const value = () => page.$eval('[id="value-specimen.length"]', (input) => input.value);
      const stated = await value();
      await page.focus('[id="value-specimen.length"]');
      await page.keyboard.press('Tab');
      for (let times = 0; times < 10; times += 1) await page.keyboard.press('ArrowRight');
      await until((old) => document.getElementById('headline').textContent !== old, before);
      expect((await value()) !== stated, 'the arrow keys do not move the slider');
      await page.focus('#undo');
      await page.keyboard.press('Enter');
      await until((old) => document.getElementById('headline').textContent === old, before);
      expect((await value()) === stated, `after undo, the length is ${await value()}, expected ${stated}`);
      await page.focus('#tab-values');
      await page.keyboard.press('ArrowRight');
      await page.keyboard.press('Tab');
      await page.keyboard.press('Tab');
      await page.keyboard.press('Enter');
      await until((old) => document.getElementById('headline').textContent !== old, before);
      said.push(...(await page.evaluate(shown)));
      await page.keyboard.down('Control');
      await page.keyboard.press('s');
      await page.keyboard.up('Control');
      for (let times = 0; times < 50 && !/reject/.test(fs.readFileSync(sheet, 'utf8')); times += 1) await new Promise((resolve) => setTimeout(resolve, 100));
      expect(/reject/.test(fs.readFileSync(sheet, 'utf8')), 'the rejected hit is not in the saved sheet');
    }
    faults.push(...said.map((fault) => `view, ${width} px, ${scheme}: ${fault}`));
    await page.close();
  }
  server.kill('SIGINT');
}
