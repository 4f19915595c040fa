import { describe, expect, it } from 'vitest';
import { compile } from '../playground/compile.ts';
import { assembled } from './build-site.ts';
import { REPOSITORY_PAGES } from './contents.ts';
import { editableExamples, packagesOf } from './examples.ts';
import { DocsError } from './markdown.ts';
import { assemblePages, checkImages, checkSidebar } from './pages.ts';

/** A repository of documents that say nothing, but for `texts`. */
const reading =
  (texts: Readonly<Record<string, string>> = {}) =>
  (path: string) =>
    texts[path] ?? '# Document\n\n## Part\n\nText.';

const assemble = (own: Readonly<Record<string, string>>, texts?: Readonly<Record<string, string>>) =>
  assemblePages(new Map(Object.entries(own)), reading(texts), (page) => page.startsWith('api/'));

describe('the pages of the site', () => {
  it('have no link, include or anchor that leads nowhere, and are all in the sidebar', () => {
    const { pages, contents } = assembled();
    expect([...pages.keys()]).toEqual(
      expect.arrayContaining([...Object.values(REPOSITORY_PAGES), 'index.md']),
    );
    expect(contents.sections.map(({ text }) => text)).toContain('API');
  });

  it('have tables whose columns all have a name, which readers of screens hear', () => {
    const nameless = [...assembled().pages].flatMap(([page, text]) =>
      [...text.matchAll(/^(\|.*\|)\n\|[-| :]+\|$/gm)]
        .filter(([, head]) =>
          head
            .slice(1, -1)
            .split('|')
            .some((cell) => cell.trim() === ''),
        )
        .map(([, head]) => `${page}: ${head}`),
    );
    expect(nameless).toEqual([]);
  });

  it('have front matter of one line per key, which YAML reads whatever the words are', () => {
    const broken = [...assembled().pages].flatMap(([page, text]) => {
      const [, front = ''] = /^---\n(.*?)\n---\n/s.exec(text) ?? [];
      const lines = front.includes('layout: home') ? [] : front.split('\n').filter(Boolean);
      return lines
        .filter((line) => !/^\w+: (?:\[[^\]]*\]|[^[{].*)$/.test(line))
        .map((line) => `${page}: ${line}`);
    });
    expect(broken).toEqual([]);
  });

  it('show every example of apps/examples, each of which the editor compiles', () => {
    const root = new URL('../../../..', import.meta.url).pathname;
    const examples = editableExamples(root);
    expect(examples.length).toBeGreaterThan(15);
    for (const { name, files } of examples) {
      const { entry, modules } = compile(files, new Set([...packagesOf(files), 'react/jsx-runtime']));
      expect(modules[entry], name).toContain('//# sourceURL=');
    }
  });
});

describe('a page', () => {
  it('includes what stands under a heading of a document, with links to the pages of others', () => {
    const { pages, images } = assemble(
      { 'guide/a.md': '# A\n\n## Here\n\n<!-- include docs/three.md#Part -->' },
      {
        'docs/three.md':
          '# Three\n\n## Part\n\n[Core](../packages/core/README.md#part), [code](../e2e), ![p](images/p.svg)',
      },
    );
    expect(pages.get('guide/a.md')).toBe(
      '# A\n\n## Here\n\n[Core](/packages/core.md#part), code, ![p](/images/p.svg)',
    );
    expect([...images]).toEqual(['docs/images/p.svg']);
  });

  it.each([
    ['[x](missing.md)', /guide\/a\.md: there is no page guide\/missing\.md/],
    ['[x](b.md#nothing)', /guide\/b\.md has no heading for “#nothing”/],
    ['<!-- include docs/three.md#Other -->', /docs\/three\.md has no heading “Other”/],
    ['<!-- include docs/three.md -->', /names no heading/],
  ])('with %s is an error that names it', (line, message) => {
    const build = () => assemble({ 'guide/a.md': `# A\n\n${line}`, 'guide/b.md': '# B' });
    expect(build).toThrow(DocsError);
    expect(build).toThrow(message);
  });

  it('shows images of the repository', () => {
    const { pages, images } = assemble({ 'guide/a.md': '# A\n\n![p](../../../../docs/images/p.svg)' });
    expect(pages.get('guide/a.md')).toContain('![p](/images/p.svg)');
    expect([...images]).toEqual(['docs/images/p.svg']);
  });

  it('links documents by their paths in the repository, which lead somewhere in a clone, too', () => {
    const texts = { 'docs/three.md': '# T\n\n## Part' };
    const linked = assemble({ 'guide/a.md': '[x](../../../../docs/three.md#part)' }, texts);
    expect(linked.pages.get('guide/a.md')).toBe('[x](/contribute/three.md#part)');
    expect(() => assemble({ 'guide/a.md': '[x](../contribute/three.md)' })).toThrow('link docs/three.md');
    expect(() => assemble({ 'guide/a.md': '[x](../../../../docs/three.md#gone)' }, texts)).toThrow('“#gone”');
  });

  it('may link to pages of the API, which are made later and checked then', () => {
    expect(() => assemble({ 'guide/a.md': '[x](../api/core/index.md)' })).not.toThrow();
  });

  it('may not have the name of a document’s page', () => {
    expect(() => assemble({ 'packages/core.md': '# Core' })).toThrow(/made of a document/);
  });
});

describe('documents of the repository', () => {
  it('may not link to headings that others do not have', () => {
    const texts = { 'CONTRIBUTING.md': '# R\n\n[x](docs/three.md#gone)' };
    expect(() => assemble({}, texts)).toThrow('CONTRIBUTING.md: docs/three.md has no heading for “#gone”.');
  });

  it('link to pages of the site by their path in the repository', () => {
    const linking = (target: string) => ({ 'docs/three.md': `# R\n\n[x](../apps/docs/pages/${target})` });
    const own = { 'guides/a.md': '# A\n\n## B' };
    expect(assemble(own, linking('guides/a.md#b')).pages.get('contribute/three.md')).toContain(
      '[x](/guides/a.md#b)',
    );
    expect(() => assemble(own, linking('guides/b.md'))).toThrow(
      'docs/three.md: there is no page guides/b.md.',
    );
    expect(() => assemble(own, linking('guides/a.md#c'))).toThrow(
      'docs/three.md: guides/a.md has no heading for “#c”.',
    );
  });
});

describe('links of documents to evidence', () => {
  const texts = { 'docs/three.md': '# T\n\n[data](../evidence/frames.json)' };

  it('lead to its page', () => {
    const { pages } = assemble({ 'evidence/frames.md': '# Frames' }, texts);
    expect(pages.get('contribute/three.md')).toContain('[data](/evidence/frames.md)');
  });

  it('are errors if there is none', () => {
    expect(() => assemble({}, texts)).toThrow('docs/three.md: there is no evidence/frames.json.');
  });
});

describe('the checks of sidebar and images', () => {
  const sections = [{ pages: [{ page: 'a.md' }] }];

  it('pass where all is there', () => {
    expect(() => checkSidebar(['a.md'], sections)).not.toThrow();
    expect(() => checkImages(new Set(), '.')).not.toThrow();
  });

  it('name pages that are missing, or in no section', () => {
    expect(() => checkSidebar(['b.md'], sections)).toThrow(
      /names a\.md, which is no page\.\nb\.md is in no section/,
    );
  });

  it('name images that are missing', () => {
    expect(() => checkImages(new Set(['docs/none.png']), '.')).toThrow(/docs\/none\.png/);
  });
});
