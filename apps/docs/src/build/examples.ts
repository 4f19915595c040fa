import { existsSync, readFileSync } from 'node:fs';
import { basename, join, posix } from 'node:path';
import { EXAMPLES } from '../../../examples/src/examples.ts';
import type { SourceFiles } from '../playground/compile.ts';
import { DocsError } from './markdown.ts';
import { siteImage } from './pages.ts';

/** An example, with the files that readers may edit. */
export interface EditableExample {
  readonly name: string;
  readonly title: string;
  readonly about: string;
  /** Path of the thumbnail in the repository; `alt` describes the image. */
  readonly picture: string;
  readonly alt: string;
  /** The module to run, followed by its relative imports. */
  readonly files: SourceFiles;
}

/** The examples of apps/examples, in the order of its index page, and this site's own examples. */
export function editableExamples(root: string): EditableExample[] {
  const routes = join(root, 'apps/examples/src');
  const ofApp = EXAMPLES.map(({ name, title, about, alt }) => ({
    ...{ name, title, about, alt },
    picture: `apps/examples/thumbnails/${name}.jpg`,
    files: withImports(routes, `routes/${name}.tsx`),
  }));
  const own = OWN_EXAMPLES.map((example) => ({
    ...example,
    picture: `apps/docs/thumbnails/${example.name}.jpg`,
    files: withImports(join(root, 'apps/docs/src/examples'), `${example.name}.ts`),
  }));
  return [...ofApp, ...own];
}

/** Examples for packages that apps/examples does not cover. */
const OWN_EXAMPLES = [
  {
    name: 'three-scene',
    title: 'Without React: three.js',
    about: 'A renderer, a scene and a cloud, in three.js alone.',
    alt: 'A small blue ball that floats above the table of the still life',
  },
  {
    name: 'plain-engine',
    title: 'Without three.js: the engine',
    about: 'A canvas, an engine and a view, without a framework.',
    alt: 'The still life from the front: a table in a meadow, with a vase, a bottle, bread and fruit',
  },
] as const;

/** `path` and all its relative imports, by path from `folder`. */
function withImports(folder: string, path: string): SourceFiles {
  const files: Record<string, string> = {};
  const add = (each: string) => {
    if (Object.hasOwn(files, each)) return;
    const file = join(folder, each);
    if (!existsSync(file)) throw new DocsError(`${path} imports ${each}, which does not exist in ${folder}.`);
    files[each] = readFileSync(file, 'utf8');
    for (const [, specifier] of files[each].matchAll(/\bfrom '(\.[^']+)'/g))
      add(posix.join(posix.dirname(each), specifier.replace(/\?raw$/, '')));
  };
  add(path);
  return files;
}

/** Entry points of the packages that `files` import. */
export function packagesOf(files: SourceFiles): string[] {
  return Object.values(files).flatMap((text) =>
    [...text.matchAll(/\b(?:from|import) '([^.'][^']*)'/g)].map(([, specifier]) => specifier),
  );
}

/** The page of an example, to run and to edit. */
export function examplePage(example: EditableExample): string {
  return [
    '---\nlayout: doc\naside: false\npageClass: wide\n---',
    `# ${example.title}`,
    example.about,
    playground(example),
  ].join('\n\n');
}

/** An example's sources as text, which scripts replace by an editor and a preview. */
function playground({ name, files }: EditableExample): string {
  const sources = Object.entries(files).map(
    ([path, text]) =>
      `<p class="file-name">${basename(path)}</p>\n\n\`\`\`${posix.extname(path).slice(1)}\n${text.trimEnd()}\n\`\`\``,
  );
  return [
    `<ws-playground name="${name}" paths="${Object.keys(files).join(' ')}">`,
    ...sources,
    '</ws-playground>\n',
  ].join('\n\n');
}

/** The page with links to all examples. */
export function examplesIndex(examples: readonly EditableExample[]): string {
  return [
    '---\nlayout: doc\naside: false\npageClass: wide\n---',
    '# Examples',
    'Each shows one thing. Change its source and press Run, or <kbd>Ctrl</kbd> <kbd>Enter</kbd>: it runs in a frame of its own, ' +
      'which can reach neither this page nor its server.',
    cards('ws-cards', examples, ({ name, title, about }) => [
      `./${name}.html`,
      `<span class="title">${title}</span><span>${about}</span>`,
    ]),
  ].join('\n\n');
}

/**
 * Replaces each line `<!-- examples NAMES -->` by linked thumbnails of these examples, and each line
 * `<!-- playground NAME -->` by the example itself, to run and to edit.
 *
 * @param page path of the text in the site.
 * @throws DocsError for an unknown example.
 */
export function withExamples(text: string, page: string, examples: readonly EditableExample[]): string {
  return text.replace(/^<!-- (examples|playground) (.+) -->$/gm, (_, kind: string, names: string) => {
    const shown = names.split(' ').map((name) => {
      const example = examples.find((each) => each.name === name);
      if (!example) throw new DocsError(`${page} shows the example ${name}, which does not exist.`);
      return example;
    });
    if (kind === 'playground') return shown.map(playground).join('\n');
    return cards('ws-cards small', shown, ({ name, title }) => [
      posix.relative(posix.dirname(page), `examples/${name}.html`),
      `<span class="title">${title}</span>`,
    ]);
  });
}

/** @param contentOf returns the URL of an example's page, and the HTML below its thumbnail. */
function cards(
  className: string,
  examples: readonly EditableExample[],
  contentOf: (example: EditableExample) => readonly [address: string, text: string],
): string {
  const items = examples.map((example) => {
    const [address, text] = contentOf(example);
    const { picture, alt } = example;
    const image = `<img src="${siteImage(picture)}" alt="${alt}" width="480" height="320" loading="lazy">`;
    return `<li><a href="${address}">${image}${text}</a></li>`;
  });
  return `<ul class="${className}">\n${items.join('\n')}\n</ul>\n`;
}
