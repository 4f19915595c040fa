import { InputFileError } from './input-error.ts';
import { isNumbers, isObject, readJsonFile, shown } from './json-file.ts';

/** Reads a scene's model matrix: 16 numbers, column-major, or `{ "matrix": […] }`. */
export async function readModelFile(file: string): Promise<Float64Array> {
  return parseModel(await readJsonFile(file, 'model matrix'), file);
}

/** @throws InputFileError that names the file and the problem. */
export function parseModel(json: unknown, file: string): Float64Array {
  const matrix = isObject(json) ? json.matrix : json;
  const place = isObject(json) ? 'field matrix' : undefined;
  if (!isNumbers(matrix, 16)) {
    throw new InputFileError(
      file,
      `a model matrix is 16 finite numbers, column-major, found ${shown(matrix)}`,
      place,
    );
  }
  const isAffine = matrix[3] === 0 && matrix[7] === 0 && matrix[11] === 0 && matrix[15] === 1;
  if (!isAffine) {
    const lastRow = [matrix[3], matrix[7], matrix[11], matrix[15]];
    const advice = 'is the matrix row-major? It is read column-major, the translation in elements 12 to 14';
    throw new InputFileError(
      file,
      `the last row must be 0, 0, 0, 1, found ${lastRow.join(', ')}; ${advice}`,
      place,
    );
  }
  return Float64Array.from(matrix);
}
