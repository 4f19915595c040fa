import { GpuLimitError, InvalidArgumentError, SplatFileError, SplatSourceError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { reportFailure } from './failure-report.ts';

describe('reportFailure', () => {
  it('keeps the engine’s own words about a file', () => {
    const error = new SplatFileError('truncated', 'a.ply', 'cut off', { byte: 12 });
    const report = reportFailure(error, 'a.ply');
    expect(report).toMatchObject({ title: 'The file is incomplete', message: 'a.ply: cut off (byte 12)' });
    expect(report.isFault).toBe(false);
  });

  it('thinks of CORS only where there was no answer', () => {
    expect(reportFailure(new SplatSourceError('a.ply', 'no answer'), 'a.ply').advice).toContain('CORS');
    expect(reportFailure(new SplatSourceError('a.ply', 'not found', 404), 'a.ply').advice).not.toContain(
      'CORS',
    );
  });

  it('names what a GPU would need', () => {
    const error = new GpuLimitError('maxBufferSize', 2e9, 1e9, 'a.ply is too large.');
    expect(reportFailure(error, 'a.ply').message).toBe(
      'a.ply is too large. (2.0 GB needed, 1.0 GB available)',
    );
  });

  it('counts lengths as lengths', () => {
    const error = new GpuLimitError('maxTextureDimension2D', 9000, 8192, 'The image is too large.');
    expect(reportFailure(error, 'a.ply').message).toBe('The image is too large.');
  });

  it('takes what was not thrown on purpose for a fault', () => {
    expect(reportFailure(new InvalidArgumentError('far', 'far is 0'), 'a.ply').isFault).toBe(false);
    expect(reportFailure(new TypeError('x is undefined'), 'a.ply').isFault).toBe(true);
    expect(reportFailure('a string', 'a.ply').message).toBe('a string');
  });
});
