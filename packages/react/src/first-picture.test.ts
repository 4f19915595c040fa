import { expect, it, vi } from 'vitest';
import { FirstPicture } from './canvas-states.ts';

it('is there once a cloud is drawn and none is being read, and is told once', () => {
  const onShown = vi.fn();
  const picture = new FirstPicture(onShown);
  const ends = [picture.read(), picture.read()];
  ends[0]();
  expect(onShown, 'before a frame').not.toHaveBeenCalled();
  picture.drawn();
  expect(onShown, 'beside a cloud that is read').not.toHaveBeenCalled();
  ends[1]();
  picture.drawn();
  expect(onShown).toHaveBeenCalledTimes(1);
});

it('is not there for clouds that leave with a Canvas that has ended', () => {
  const onShown = vi.fn();
  const picture = new FirstPicture(onShown);
  const end = picture.read();
  picture.drawn();
  picture.end();
  end();
  expect(onShown).not.toHaveBeenCalled();
});
