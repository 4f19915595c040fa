import { expect, test } from 'vitest';
import { type PageContents, writePage } from './page-text.ts';

const TEMPLATE =
  '<!doctype html><html lang="en"><head><title>WebSplatter</title><script>"</body><title>x</title>"</script></head><body><div id="root"></div></body></html>';

function written(contents: Partial<PageContents>, signal = new AbortController().signal): Promise<Blob> {
  const parts: number[] = [];
  const whole = { title: 'a.ply', view: 'camera=0', background: null, parts: [], ...contents };
  return writePage(TEMPLATE, whole, { signal, onPart: (part) => parts.push(part) });
}

test('names of files and scenes are no markup of the page', async () => {
  const title = '</script></title><b>"a" & \'b\' $& $1';
  const part = { title, builtin: null, files: [{ path: `${title}.ply`, bytes: new Blob(['abc']) }] };
  const text = await (await written({ title, view: 'crop=1&mode="', parts: [part] })).text();
  const safe = "&lt;/script&gt;&lt;/title&gt;&lt;b&gt;&quot;a&quot; &amp; 'b' $&amp; $1";
  expect(text).toBe(
    `<!doctype html><html lang="en"><head><title>${safe}</title>\n<meta name="websplatter-view" content="crop=1&amp;mode=&quot;">` +
      '<script>"</body><title>x</title>"</script></head><body><div id="root"></div>' +
      `<div hidden data-part="${safe}">\n<script type="application/octet-stream" data-path="${safe}.ply">YWJj</script>\n</div>\n` +
      '</body></html>',
  );
});

test('the page has the colour of the picture before there is one', async () => {
  const page = await written({ background: '#ff8000' });
  expect(await page.text()).toContain('<html style="--scene-background: #ff8000" lang="en">');
});

test('large files are base64 as a whole, however they are cut', async () => {
  const bytes = Uint8Array.from({ length: 3 * 2 ** 20 + 2 }, (_, i) => (i * 40_503) >>> 8);
  const files = [{ path: 'a.ply', bytes: new Blob([bytes]) }];
  const page = await written({ parts: [{ title: 'a', builtin: 'still-life', files }] });
  const text = await page.text();
  expect(text).toContain('<div hidden data-part="a" data-builtin="still-life">');
  const base64 = /data-path="a\.ply">([^<]*)</.exec(text)?.[1] ?? '';
  expect(Buffer.from(base64, 'base64').equals(bytes)).toBe(true);
  expect(base64).toBe(Buffer.from(bytes).toString('base64'));
});

test('writing ends where it is cancelled', async () => {
  const files = [{ path: 'a', bytes: new Blob(['a']) }];
  const cancelled = written({ parts: [{ title: 'a', builtin: null, files }] }, AbortSignal.abort('over'));
  await expect(cancelled).rejects.toBe('over');
});
