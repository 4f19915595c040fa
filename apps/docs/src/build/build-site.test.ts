import { describe, expect, it } from 'vitest';
import { linkProblems } from './build-site.ts';

const problemsOf = (html: string, base = '/docs/') =>
  linkProblems(
    new Map([
      ['guide/a.html', html],
      ['guide/b.html', '<h2 id="part">Part</h2>'],
      ['index.html', ''],
      ['images/p.svg', null],
    ]),
    base,
  );

describe('the links of a built site', () => {
  it.each([
    '<a href="/docs/guide/b.html#part">',
    '<a href="b.html">',
    '<a href="/docs/">',
    '<a href="#top"><i id="top">',
    '<img src="../images/p.svg">',
    '<a href="https://example.org/x">',
    '<a href="/docs/guide/b.html?x&amp;y">',
  ])('pass where there is something: %s', (html) => expect(problemsOf(html)).toEqual([]));

  it.each([
    ['<a href="c.html">', 'guide/a.html: there is nothing at c.html.'],
    ['<a href="/docs/guide/">', 'guide/a.html: there is nothing at /docs/guide/.'],
    ['<a href="b.html#other">', 'guide/a.html: guide/b.html has no “#other”.'],
    ['<a href="#nowhere">', 'guide/a.html: guide/a.html has no “#nowhere”.'],
    ['<script src="/app.js">', 'guide/a.html: /app.js leads out of /docs/.'],
    ['<img src="/docs/images/q.svg">', 'guide/a.html: there is nothing at /docs/images/q.svg.'],
  ])('fail where there is nothing: %s', (html, problem) => expect(problemsOf(html)).toEqual([problem]));
});
