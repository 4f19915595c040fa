import { describe, expect, it } from 'vitest';
import { DocsError, headingsOf, mapLinks, resolveLink, sectionOf } from './markdown.ts';

const TEXT = `# Title

Before.

## Loading \`files\`

Text.

\`\`\`sh
## no heading
\`\`\`

### More

Deeper.

## Loading files

After.
`;

describe('headings', () => {
  it('have anchors without markup, numbered where they repeat, and are none in code', () => {
    expect(headingsOf(TEXT).map(({ level, slug }) => [level, slug])).toEqual([
      [1, 'title'],
      [2, 'loading-files'],
      [3, 'more'],
      [2, 'loading-files-1'],
    ]);
  });
});

describe('a section', () => {
  it('ends at the next heading of its level, and is moved below the heading that it will stand under', () => {
    const section = sectionOf('a.md', TEXT, 'Loading files', 3);
    expect(section).toContain('## no heading');
    expect(section).toContain('\n#### More\n');
    expect(section).not.toContain('After');
  });

  it('that does not exist is an error with those that do', () => {
    expect(() => sectionOf('a.md', TEXT, 'Saving', 2)).toThrow(DocsError);
    expect(() => sectionOf('a.md', TEXT, 'Saving', 2)).toThrow(
      /a\.md has no heading “Saving”; it has “Title”, “Load/,
    );
  });
});

describe('links', () => {
  it('are mapped outside of code, images apart, or lose their target', () => {
    const text = 'See [one](a.md#b), ![two](c.svg), [`three`](d) and `[four](e)`.\n```\n[five](f)\n```';
    const mapped = mapLinks(text, (target, isImage) =>
      target === 'd' ? null : `${isImage ? 'i' : 'l'}:${target}`,
    );
    expect(mapped).toBe(
      'See [one](l:a.md#b), ![two](i:c.svg), `three` and `[four](e)`.\n```\n[five](f)\n```',
    );
  });

  it('are mapped if they go on in the next line', () => {
    const text = 'See [one\ntwo](a.md) and `code\n\n[three](b.md)` here';
    expect(mapLinks(text, (target) => `l:${target}`)).toBe(
      'See [one\ntwo](l:a.md) and `code\n\n[three](l:b.md)` here',
    );
  });

  it.each([
    ['b.md#x', { path: 'docs/b.md', anchor: 'x' }],
    ['../README.md', { path: 'README.md', anchor: '' }],
    ['/guide/a.md', { path: 'guide/a.md', anchor: '' }],
    ['#here', { path: 'docs/a.md', anchor: 'here' }],
    ['https://three.org/#x', null],
    ['mailto:a@b', null],
  ])('to %s are resolved', (target, link) => expect(resolveLink('docs/a.md', target)).toEqual(link));
});
