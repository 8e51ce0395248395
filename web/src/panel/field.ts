/** lil-gui edits a property of an object; a field is such an object over any getter and setter. */

export interface Field<T> {
  value: T;
}

export function field<T>(get: () => T, set: (value: T) => void): Field<T> {
  return Object.defineProperty({} as Field<T>, 'value', { get, set, enumerable: true });
}
