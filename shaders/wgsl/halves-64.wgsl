// Registers and strides of a perceptron in half precision, with up to 64 units in each hidden layer.
// enable: f16

// Texels of a feature's column of the first matrix, and of a row of blocks of the others.
const irradia_column_texels: u32 = 8u;
const irradia_row_texels: u32 = 32u;

// What a hidden layer hands to the next.
var<private> irradia_halves: array<vec4h, 16>;
