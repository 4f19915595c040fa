import { describe, expect, it } from 'vitest';
import { linkedStart } from './linked-start.ts';

describe('the start from a link', () => {
  it('is nothing where the address tells nothing', () => {
    expect(linkedStart(new URLSearchParams('scene=still-life'))).toEqual({
      accuracy: null,
      camera: null,
      comparison: null,
      viewMode: 'colours',
      background: null,
      detail: null,
      looks: [],
      notice: null,
    });
  });

  it('has the camera, the comparison, the detail and the view mode of the address', () => {
    const { camera, comparison, detail, viewMode, notice } = linkedStart(
      new URLSearchParams('camera=0,0,0,2,0,1&compare=error&detail=maxSplats:500&mode=centres'),
    );
    expect(viewMode).toBe('centres');
    expect(camera?.pose.distance).toBe(2);
    expect(comparison?.comparison.kind).toBe('error');
    expect(detail).toEqual({ maxSplats: 500 });
    expect(notice).toBeNull();
  });

  it('has the background of the address, or says why not', () => {
    const start = (text: string) =>
      linkedStart(new URLSearchParams(`background=${encodeURIComponent(text)}`));
    for (const text of ['ff8800', 'F80', '#ff8800', ' ff8800 '])
      expect(start(text).background).toBe('#ff8800');
    for (const text of ['', 'red', 'ff80', '#'])
      expect(start(text)).toMatchObject({
        background: null,
        notice: expect.stringContaining('background=000'),
      });
  });

  it('has the look of each file, in their order', () => {
    const { looks } = linkedStart(new URLSearchParams('place&place=hidden:1'));
    expect(looks).toEqual(['', 'hidden:1']);
  });

  /**
   * @fault Arguments: the viewer's URL has an invalid camera, comparison or view mode
   * @consequence the scene's first view, in its colours, and a notice
   */
  it('leaves out what cannot be read, and says so', () => {
    const { camera, comparison, detail, viewMode, notice } = linkedStart(
      new URLSearchParams('camera=near&compare=fast/high&detail=maxSplats:few&mode=x-ray'),
    );
    expect(viewMode).toBe('colours');
    expect(notice).toContain('“x-ray”; there are colours, ellipsoids,');
    expect(camera).toBeNull();
    expect(comparison?.comparison.kind).toBe('split');
    expect(notice).toContain('“near” is no number');
    expect(detail).toBeNull();
    expect(notice).toContain('{ maxSplats: 1e6 }');
  });

  it('has the accuracy of the address, or says that there is none such', () => {
    expect(linkedStart(new URLSearchParams('accuracy=fast')).accuracy).toMatchObject({ rasterizer: 'auto' });
    expect(linkedStart(new URLSearchParams('accuracy=foo'))).toMatchObject({
      accuracy: null,
      notice: expect.stringContaining('The address asks for an unknown accuracy.'),
    });
  });
});
