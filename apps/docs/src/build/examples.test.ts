import { expect, test } from 'vitest';
import { withExamples } from './examples.ts';
import { DocsError } from './markdown.ts';

const EXAMPLES = ['clip', 'fog'].map((name) => ({
  name,
  title: `Title of ${name}`,
  about: 'About',
  picture: `apps/examples/thumbnails/${name}.jpg`,
  alt: `Picture of ${name}`,
  files: {},
}));

test('pictures of examples stand where a page names them, and lead to them', () => {
  const text = withExamples('# A\n\n<!-- examples fog clip -->\n\nB', 'guide/a.md', EXAMPLES);
  expect(text.startsWith('# A\n\n<ul class="ws-cards small">\n')).toBe(true);
  expect(text.endsWith('</ul>\n\n\nB')).toBe(true);
  expect([...text.matchAll(/href="(.+?)".+?src="(.+?)" alt="(.+?)".+?>(Title of .+?)</g)]).toMatchObject([
    { 1: '../examples/fog.html', 2: '/images/fog.jpg', 3: 'Picture of fog', 4: 'Title of fog' },
    { 1: '../examples/clip.html', 2: '/images/clip.jpg', 3: 'Picture of clip', 4: 'Title of clip' },
  ]);
});

test('an example that there is none of is an error that names it', () => {
  const build = () => withExamples('<!-- examples fog mist -->', 'guide/a.md', EXAMPLES);
  expect(build).toThrow(DocsError);
  expect(build).toThrow(/guide\/a\.md shows the example mist/);
});
