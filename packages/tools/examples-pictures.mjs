// `npm run examples:pictures`: draws the thumbnails of the examples with SwiftShader, into
// apps/examples/thumbnails. `-- fog clip` draws only the thumbnails of these examples.
import { mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { ensureChromium, ensureInstalled, fail, repositoryRoot } from './setup.mjs';

const SIZE = { width: 480, height: 320 };
const MAX_BYTES = 16_000;
const MAX_QUALITY = 80;
/** An empty page has about 2 kB, and a panel adds 3 kB. */
const MIN_BYTES = 4_000;
const MIN_BYTES_WITH_PANEL = 8_000;
const MAX_ACTIONS = 5;
/** Most shots before the example counts as never at rest. */
const MAX_SHOTS = 10;
const MAX_EMPTY_SHOTS = 200;

/** Presses the page's button, which thumbnails do not show. */
const press = (page) => page.evaluate(() => document.querySelector('.panel button').click());

/** Moves the page's slider. */
const slide = (page, value) => page.locator('.panel input[type=range]').evaluate(moveTo, value);

function moveTo(slider, value) {
  slider.value = value;
  slider.dispatchEvent(new Event('input', { bubbles: true }));
}

/** Input for examples whose initial scene does not show their point. */
const ACTIONS = {
  annotations: async (page) => {
    for (const xPx of [142, 320]) {
      await page.mouse.click(xPx, 184);
      await page.waitForTimeout(3_000);
    }
  },
  bones: (page) => slide(page, '0.8'),
  colliders: async (page) => {
    for (let ball = 0; ball < 12; ball++) await press(page);
  },
  // Its stripes are drawn before its splats.
  fade: (page) => page.waitForTimeout(3_000),
  'frames-file': (page) => slide(page, '5'),
  morph: (page) => slide(page, '0.58'),
  'moving-scene': (page) => slide(page, '0.5'),
  picking: ({ mouse }) => mouse.click(302, 150),
  selection: ({ mouse }) => mouse.click(174, 180),
};

/** Examples whose panel is part of the thumbnail. */
const WITH_PANEL = ['accuracy', 'demand-loop', 'file-drop'];

const app = join(repositoryRoot, 'apps/examples');
const docs = join(repositoryRoot, 'apps/docs');
const ofApp = readdirSync(join(app, 'src/routes')).map((file) => basename(file, '.tsx'));
const ofDocs = readdirSync(join(docs, 'src/examples')).map((file) => basename(file, '.ts'));
const names = [...ofApp, ...ofDocs];
const chosen = process.argv.slice(2);
const unknown = chosen.find((name) => !names.includes(name));
if (unknown) fail(`There is no example “${unknown}”: choose of ${names.join(', ')}.`);

ensureInstalled('apps/examples', 'apps/docs');
const executablePath = ensureChromium();
const { build, preview, runnerImport } = await import('vite');
const launcher = join(repositoryRoot, 'packages/tools/src/browser.ts');
const { module } = await runnerImport(launcher, { configFile: false, logLevel: 'error' });
const outDir = mkdtempSync(join(tmpdir(), 'websplatter-examples-'));
const common = { configFile: join(app, 'vite.config.ts'), logLevel: 'error', build: { outDir } };
await build(common);
const rolldownOptions = {
  input: ofDocs.map((name) => join(docs, `src/examples/${name}.ts`)),
  output: { entryFileNames: '[name].js' },
};
await build({ ...common, build: { outDir, emptyOutDir: false, rolldownOptions } });
const server = await preview({ ...common, preview: { host: '127.0.0.1', port: 0 } });
const browser = await module.launchBrowser({ executablePath, usesGpu: false });
try {
  for (const name of chosen.length > 0 ? chosen : names) {
    const page = await browser.newPage({ viewport: SIZE, reducedMotion: 'reduce' });
    const hasPanel = WITH_PANEL.includes(name);
    await page.addInitScript(showStageAlone, hasPanel);
    // This example shows the placeholder and the progress bar.
    if (name === 'suspense') await page.route('**/still-life.sog', () => {});
    const isOfDocs = ofDocs.includes(name);
    await page.route(`**/${name}.html`, (route) =>
      route.fulfill({ body: pageOf(name), contentType: 'text/html' }),
    );
    await page.goto(server.resolvedUrls.local[0] + (isOfDocs ? `${name}.html` : `?example=${name}`));
    const minBytes = hasPanel ? MIN_BYTES_WITH_PANEL : MIN_BYTES;
    const first = await pictureAtRest(page, minBytes);
    let bytes = first;
    // Rays miss splats for a moment after the first picture.
    for (let i = 0; i < MAX_ACTIONS && name in ACTIONS && bytes.equals(first); i++) {
      await ACTIONS[name](page);
      bytes = await pictureAtRest(page, minBytes);
    }
    writeFileSync(join(isOfDocs ? docs : app, 'thumbnails', `${name}.jpg`), bytes);
    console.log(`${name}: ${bytes.length.toLocaleString('en')} bytes`);
    await page.close();
  }
} finally {
  await browser.close();
  await server.close();
  rmSync(outDir, { recursive: true });
}

/** The page of an example of the docs. */
function pageOf(name) {
  return `<!doctype html>
    <style>
      html, body { height: 100%; margin: 0; background: #f4f5f7; }
      canvas { display: block; width: 100%; height: 100%; }
    </style>
    <body><script type="module" src="./${name}.js"></script>`;
}

/** Executed in the page. */
function showStageAlone(hasPanel) {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(`
    .example { grid-template-rows: 100% !important; }
    .example-bar${hasPanel ? '' : ', .panel:not(:has(progress))'} { display: none !important; }
  `);
  document.adoptedStyleSheets.push(sheet);
}

/** Returns a JPEG with the highest quality that fits the size limit. */
async function pictureAtRest(page, minBytes) {
  const shot = (quality) => page.screenshot({ type: 'jpeg', quality, timeout: 0 });
  let last = Buffer.alloc(0);
  let before;
  for (let empty = 0, shots = 0; shots < MAX_SHOTS && !(shots > 1 && last.equals(before)); ) {
    await page.waitForTimeout(500);
    before = last;
    last = await shot(MAX_QUALITY);
    if (last.length >= minBytes) shots++;
    else if (empty++ > MAX_EMPTY_SHOTS) throw new Error(`${page.url()} draws nothing.`);
  }
  for (let quality = MAX_QUALITY - 5; last.length > MAX_BYTES; quality -= 5) last = await shot(quality);
  return last;
}
