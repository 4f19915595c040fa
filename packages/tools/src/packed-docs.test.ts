import { fileURLToPath } from 'node:url';
import { describe, expect, it, test } from 'vitest';
import { deadLinks, packedDocs } from './packed-docs.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/**
 * @fault Pages and packages: a packed README links to files of the repository
 * @consequence the pages are packed, and their links lead to each other
 */
describe.each(['core', 'three', 'react', 'scenes'])('the documents of %s', (name) => {
  const docs = packedDocs(root, name);

  it('have no dead link', () => {
    expect(deadLinks(docs)).toEqual([]);
    expect(docs.get('README.md')).toMatch(new RegExp(`^# @websplatter/${name}\n[^]*\\(\\./docs/`));
  });

  it('are pages for users, in plain Markdown', () => {
    for (const [path, text] of docs) {
      expect(path).toMatch(/^(?:README\.md|docs\/(?:learn|guides|shipping|hood)\/[a-z-]+\.md)$/);
      expect(text, path).toMatch(/^# /);
      expect(text, path).not.toMatch(/^(?:<!--|<ws-|---$)/m);
    }
  });
});

test('documents of packages have the options of effects, also of one’s own', () => {
  for (const name of ['core', 'three', 'react'])
    expect(packedDocs(root, name).get('docs/guides/write-an-effect.md')).toContain('defineEffect');
});

test('dead links are those to missing files and to missing headings', () => {
  const files = new Map([
    [
      'README.md',
      '# A\n\n[a](docs/b.md#part), [b](docs/c.md), [c](#a), [d](#z), [e](https://host.example/x)',
    ],
    ['docs/b.md', '## Part\n\n[f](../README.md#a), [g](../README.md#z), `[h](code.md)`'],
  ]);
  expect(deadLinks(files)).toEqual([
    'README.md: there is no docs/c.md, which “docs/c.md” leads to',
    'README.md: README.md has no heading for “#z”',
    'docs/b.md: README.md has no heading for “#z”',
  ]);
});
