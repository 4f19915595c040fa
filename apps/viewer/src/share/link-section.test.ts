import { expect, test } from 'vitest';
import { frameText } from './link-section.tsx';

test('a frame shows the picture alone; its texts are no markup', () => {
  expect(frameText('https://example.org/?src=a.ply&camera=1#top', '"a" & <b>')).toBe(
    '<iframe src="https://example.org/?src=a.ply&amp;camera=1&amp;noui" title="&quot;a&quot; &amp; &lt;b&gt;" width="640" height="400" style="border: 0" allow="fullscreen"></iframe>',
  );
});
