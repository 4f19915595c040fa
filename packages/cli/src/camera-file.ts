import {
  type Camera,
  cameraFromMatrices,
  InvalidArgumentError,
  orthographicCamera,
  perspectiveCamera,
} from '@websplatter/core';
import { InputFileError } from './input-error.ts';
import { isNumbers, isObject, readJsonFile, shown } from './json-file.ts';

type Point = [number, number, number];

/** Reads a camera for images of the given `aspect` (width divided by height). */
export async function readCameraFile(file: string, aspect: number): Promise<Camera> {
  return parseCamera(await readJsonFile(file, 'camera'), file, aspect);
}

/**
 * Makes a camera from the contents of a camera file: `position`, `target`, `up`, `near`, `far` with
 * `fovYDegrees`, or with `"projection": "orthographic"` and `height`; or `viewMatrix` and
 * `projectionMatrix`, column-major. Unknown fields are ignored.
 *
 * @throws InputFileError that names the file and the field.
 */
export function parseCamera(json: unknown, file: string, aspect: number): Camera {
  if (!isObject(json)) throw new InputFileError(file, `a camera is an object, found ${shown(json)}`);
  const fields = new CameraFields(json, file);
  try {
    if ('viewMatrix' in json || 'projectionMatrix' in json) {
      return cameraFromMatrices(fields.numbers('viewMatrix', 16), fields.numbers('projectionMatrix', 16), {
        near: fields.optionalNumber('near'),
        far: fields.optionalNumber('far'),
      });
    }
    const placement = {
      position: fields.numbers('position', 3) as Point,
      target: fields.numbers('target', 3) as Point,
      up: 'up' in json ? (fields.numbers('up', 3) as Point) : undefined,
      near: fields.optionalNumber('near'),
      far: fields.optionalNumber('far'),
      aspect,
    };
    const projection = json.projection ?? 'perspective';
    if (projection === 'perspective') {
      return perspectiveCamera({ ...placement, fovYDegrees: fields.number('fovYDegrees') });
    }
    if (projection === 'orthographic')
      return orthographicCamera({ ...placement, height: fields.number('height') });
    throw fields.error('projection', 'must be "perspective" or "orthographic"');
  } catch (error) {
    if (error instanceof InvalidArgumentError) {
      throw new InputFileError(file, error.message, `field ${error.argument}`, { cause: error });
    }
    throw error;
  }
}

/** Typed access to the fields of one camera file. */
class CameraFields {
  constructor(
    private readonly json: Record<string, unknown>,
    private readonly file: string,
  ) {}

  number(name: string): number {
    const value = this.json[name];
    if (typeof value !== 'number' || !Number.isFinite(value))
      throw this.error(name, 'must be a finite number');
    return value;
  }

  optionalNumber(name: string): number | undefined {
    return name in this.json ? this.number(name) : undefined;
  }

  numbers(name: string, length: number): number[] {
    const value = this.json[name];
    if (!isNumbers(value, length)) throw this.error(name, `must be ${length} finite numbers`);
    return value;
  }

  error(name: string, requirement: string): InputFileError {
    return new InputFileError(
      this.file,
      `${name} ${requirement}, found ${shown(this.json[name])}`,
      `field ${name}`,
    );
  }
}
