import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, posix, relative } from 'node:path';
import { fileURLToPath } from 'node:url';
import { apiEntries } from './api-entries.ts';
import { evidenceIndex, evidencePage, readEvidence } from './evidence.ts';
import { editableExamples, examplePage, examplesIndex, packagesOf, withExamples } from './examples.ts';
import { faultsIn, proofsIn, withFaults, withProofs } from './faults.ts';
import { DocsError } from './markdown.ts';
import { type Assembled, assemblePages, checkImages, checkSidebar } from './pages.ts';
import { type SiteContents, siteContents } from './site-contents.ts';

const docs = fileURLToPath(new URL('../..', import.meta.url));
const root = join(docs, '../..');
/** Shown on the first page; an image of no document of the site. */
const FRONT_IMAGE = 'docs/images/still-life.webp';
/** Folder in which the pages are assembled for VitePress. */
const site = join(docs, '.site');

export interface BuildSiteOptions {
  /** Path under which the site will be served, with a slash at both ends; default `/`. */
  readonly base?: string;
  /** Folder of the built site; default `apps/docs/dist`. */
  readonly outDir?: string;
  /** Called after each completed step. */
  readonly log?: (line: string) => void;
}

/**
 * Builds the documentation site for any web server.
 *
 * @throws DocsError for broken links, includes and anchors; errors of VitePress, TypeDoc and Vite.
 */
export async function buildSite({
  base = '/',
  outDir = join(docs, 'dist'),
  log = () => {},
}: BuildSiteOptions = {}) {
  const timed = async <Result>(name: string, step: () => Result | Promise<Result>): Promise<Result> => {
    const startedMs = performance.now();
    const result = await step();
    log(`${name}: ${((performance.now() - startedMs) / 1000).toFixed(1)} s`);
    return result;
  };
  rmSync(site, { recursive: true, force: true });
  await timed('Pages', assembleSite);
  await timed('API', async () => (await import('./api.ts')).writeApi(root, join(site, 'api')));
  await timed('Packages for the examples', async () => {
    const examples = editableExamples(root).map(({ files }) => files);
    const { buildKit } = await import('./kit.ts');
    await buildKit(
      docs,
      join(site, 'public/kit'),
      examples.flatMap(packagesOf),
      examples.flatMap(dreiNamesOf),
    );
  });
  await timed('HTML', async () => {
    const { build } = await import('vitepress');
    process.env.WEBSPLATTER_DOCS_BASE = base;
    await build(docs, { outDir });
  });
  const problems = await timed('Links', () => linkProblems(builtFiles(outDir), base));
  if (problems.length > 0) throw new DocsError(problems.join('\n'));
}

/** Assembles pages and images, without the API, in the folder that VitePress reads. */
function assembleSite(): void {
  const { pages, images, contents } = assembled();
  for (const [page, text] of pages) write(page, text);
  for (const path of images) {
    const target = join(site, 'public/images', basename(path));
    mkdirSync(dirname(target), { recursive: true });
    cpSync(join(root, path), target);
  }
  cpSync(join(root, 'apps/examples/icon.svg'), join(site, 'public/icon.svg'));
  write('contents.json', JSON.stringify(contents));
}

/**
 * Assembles all pages except the API's from the repository's current state. Quick; finds broken
 * links, includes and anchors.
 *
 * @throws DocsError that names them.
 */
export function assembled(): Assembled & { readonly contents: SiteContents } {
  const examples = editableExamples(root);
  const entries = apiEntries(root);
  const folder = join(docs, 'pages');
  const own = new Map(
    filesIn(folder).map((path) => {
      const page = relative(folder, path);
      return [page, withExamples(readFileSync(path, 'utf8'), page, examples)];
    }),
  );
  own.set('examples/index.md', examplesIndex(examples));
  for (const example of examples) own.set(`examples/${example.name}.md`, examplePage(example));
  const evidence = readEvidence(root);
  own.set('evidence/index.md', evidenceIndex(evidence));
  for (const [name, each] of evidence) own.set(`evidence/${name}.md`, evidencePage(each));
  const tests = testFiles();
  const faults = faultsIn(tests);
  const proofs = proofsIn(tests);
  const { pages, images } = assemblePages(
    own,
    (path) => withProofs(withFaults(readFileSync(join(root, path), 'utf8'), faults), proofs),
    (page) => page.startsWith('api/'),
  );
  const contents = siteContents(examples, entries, evidence);
  const apiPages = ['api/index.md', ...entries.map(({ name }) => `api/${name}/index.md`)];
  checkSidebar(
    [...pages.keys(), ...apiPages].filter((page) => page !== 'index.md'),
    contents.sections,
  );
  const allImages = new Set([FRONT_IMAGE, ...examples.map(({ picture }) => picture), ...images]);
  checkImages(allImages, root);
  return { pages, images: allImages, contents };
}

/** Texts of the repository's test files, by path. */
function testFiles(): ReadonlyMap<string, string> {
  const isTest = /\.test\.(?:ts|tsx|mjs)$/;
  const isOther = /^(?:node_modules|dist|\..*)$/;
  const within = (folder: string): string[] =>
    readdirSync(join(root, folder), { withFileTypes: true }).flatMap((entry) => {
      const path = posix.join(folder, entry.name);
      if (entry.isDirectory()) return isOther.test(entry.name) ? [] : within(path);
      return isTest.test(entry.name) ? [path] : [];
    });
  const paths = ['packages', 'apps', 'e2e'].flatMap(within).sort();
  return new Map(paths.map((path) => [path, readFileSync(join(root, path), 'utf8')]));
}

function write(path: string, text: string): void {
  const file = join(site, path);
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, text);
}

/** Names that modules import from drei. */
function dreiNamesOf(files: Readonly<Record<string, string>>): string[] {
  return Object.values(files).flatMap((text) =>
    [...text.matchAll(/import \{([^}]*)\} from '@react-three\/drei'/g)].flatMap(([, names]) =>
      names
        .split(',')
        .map((name) => name.trim())
        .filter((name) => name && !name.startsWith('type ')),
    ),
  );
}

function builtFiles(folder: string): BuiltFiles {
  return new Map(
    filesIn(folder).map((path) => [
      relative(folder, path),
      path.endsWith('.html') ? readFileSync(path, 'utf8') : null,
    ]),
  );
}

function filesIn(folder: string): string[] {
  return readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name));
}

/** A file of the built site: text of HTML pages, null for all others. */
type BuiltFiles = ReadonlyMap<string, string | null>;

/**
 * Checks the links, images, scripts and anchors of built pages against the files.
 *
 * @param files by path in the site, e.g. `guide/loading.html`
 * @param base path under which the site is served, with a slash at both ends
 * @returns problems, one line each
 */
export function linkProblems(files: BuiltFiles, base: string): string[] {
  const anchors = new Map<string, Set<string>>();
  const anchorsOf = (path: string) => {
    const known = anchors.get(path) ?? new Set(attributes(files.get(path)!, /\s(?:id|name)="([^"]*)"/g));
    anchors.set(path, known);
    return known;
  };
  return [...files].flatMap(([path, html]) => {
    if (html === null) return [];
    // A relative target is right at the page's own address only; 404.html is shown at any.
    const targets = new Set(attributes(html, /\s(?:href|src)="([^"]*)"/g));
    return [...targets].flatMap((target) => {
      if (/^(?:https?|mailto|data|blob):/.test(target)) return [];
      const url = new URL(target, `http://site${base}${path}`);
      const name = decodeURIComponent(url.pathname);
      if (!name.startsWith(base)) return [`${path}: ${target} leads out of ${base}.`];
      const file = fileAt(name.slice(base.length), files);
      if (file === null) return [`${path}: there is nothing at ${target}.`];
      const anchor = decodeURIComponent(url.hash.slice(1));
      if (anchor && files.get(file) !== null && !anchorsOf(file).has(anchor))
        return [`${path}: ${file} has no “#${anchor}”.`];
      return [];
    });
  });
}

/** The file that a plain web server sends for `path`; null for none. */
function fileAt(path: string, files: BuiltFiles): string | null {
  const file = path === '' || path.endsWith('/') ? posix.join(path, 'index.html') : path;
  return files.has(file) ? file : null;
}

function attributes(html: string, pattern: RegExp): string[] {
  return [...html.matchAll(pattern)].map(([, value]) =>
    value.replaceAll('&amp;', '&').replaceAll('&quot;', '"').replaceAll('&#39;', "'"),
  );
}
